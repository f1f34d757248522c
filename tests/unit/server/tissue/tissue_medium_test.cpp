#include "forcebound/server/tissue/tissue_medium.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/recorded_data.hpp"
#include "tests/support/tissue_block.hpp"

namespace forcebound::server {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr double kTop_m = 0.03;

TissueDescription block_description() {
  TetrahedralMesh mesh(test::tetrahedra_of({.cubes = {6, 6, 3}, .cube_m = 0.01}));
  std::vector<int> held = nodes_below(mesh, Point::Zero(), Point::UnitZ());
  return {.mesh = std::move(mesh), .material = {.young_Pa = 5000, .poisson = 0.4}, .held_nodes = std::move(held)};
}

TissueMedium block(const ProbeOptions& probe, bool large_motion = false) {
  TissueDescription description = block_description();
  description.probe = probe;
  description.large_motion = large_motion;
  return TissueMedium(std::move(description));
}

/// The laws, each in a block of its own.
std::vector<TissueMedium> blocks() {
  std::vector<TissueMedium> media;
  media.push_back(block({.radius_m = 0}));
  media.push_back(block({.radius_m = 0.01}));
  media.push_back(block({.contact_stiffness_N_per_m = 1e3}, true));
  return media;
}

MediumTouch go(MediumState& state, int seat, const Point& from_m, const Point& to_m, int steps = 30) {
  for (int n = 0; n <= steps; ++n) {
    state.move(seat, from_m + (to_m - from_m) * n / steps, Point::Zero());
    state.advance(1e-3);
  }
  return state.touch(seat);
}

TEST(TissueMedium, IsFeltWhereItsFactsSaySurfaceIs) {
  for (const TissueMedium& medium : blocks()) {
    const Point surface_m = medium.facts().on_surface_m;
    EXPECT_LT((surface_m - Point(0.03, 0.03, kTop_m)).norm(), 1e-9);
    const auto state = medium.make_state(1);
    const int seat = state->join();
    EXPECT_EQ(state->touch(seat).force_N, Point::Zero());
    const MediumTouch above = go(*state, seat, surface_m + Point(0, 0, 0.03), surface_m + Point(0, 0, 0.011));
    EXPECT_EQ(above.force_N, Point::Zero());
    EXPECT_FALSE(above.penetration_m > 0);
    const MediumTouch within = go(*state, seat, surface_m + Point(0, 0, 0.011), surface_m - Point(0, 0, 0.001));
    EXPECT_GT(within.force_N.z(), 0.01);
    EXPECT_GT(within.normal.z(), 0.99);
    EXPECT_GT(within.penetration_m, 0.0009);
    EXPECT_TRUE(state->sound());
  }
}

TEST(TissueMedium, TimeDoesNotMatter) {
  for (const TissueMedium& medium : blocks()) {
    const auto slow = medium.make_state(1);
    const auto fast = medium.make_state(1);
    const int slow_seat = slow->join();
    const int fast_seat = fast->join();
    for (int n = 0; n <= 20; ++n) {
      const Point at_m(0.03, 0.031, kTop_m + 0.012 - 0.001 * n);
      slow->move(slow_seat, at_m, Point(0, 0, -1));
      slow->advance(1);
      fast->move(fast_seat, at_m, Point(0, 0, -1000));
      fast->advance(1e-6);
      EXPECT_EQ(slow->touch(slow_seat).force_N, fast->touch(fast_seat).force_N);
    }
    EXPECT_GT(slow->touch(slow_seat).force_N.z(), 0.01);
  }
}

}  // namespace
}  // namespace forcebound::server
