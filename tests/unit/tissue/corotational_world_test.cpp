#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "forcebound/tissue/tissue_world.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/tissue_block.hpp"

namespace forcebound::tissue {
namespace {

using test::kThinBlock;
using test::kThinTop_m;
using test::tetrahedra_of;

constexpr double kContact_N_per_m = 500;
const ElasticMaterial kCompressible{.young_Pa = 5000, .poisson = 0.3};
const std::array<scene::Point, 2> kBesideOnTop_m{scene::Point(0.0143, 0.0232, kThinTop_m),
                                                 scene::Point(0.0281, 0.0177, kThinTop_m)};

const CorotationalOptions kUsual{.contact_stiffness_N_per_m = kContact_N_per_m, .tolerance = 1e-7};

CorotationalTissue compressible_block(const CorotationalOptions& options = kUsual) {
  TetrahedralMesh mesh(tetrahedra_of(kThinBlock));
  const std::vector<int> held = nodes_below(mesh, scene::Point::Zero(), scene::Point::UnitZ());
  return {std::move(mesh), kCompressible, held, options};
}

template <typename World>
const TissueResult& move(World& world, int seat, const scene::Point& position_m) {
  world.move(seat, position_m, scene::Point::Zero());
  return world.seat(seat).result;
}

/// Both come down from above by turns, and stay.
template <typename World>
void press(World& world, double depth_m) {
  while (world.join() >= 0) continue;
  for (int n = 0; n <= 50; ++n) {
    const scene::Point at_m(0, 0, 0.004 - (0.004 + depth_m) * std::min(1.0, n / 40.0));
    for (int seat = 0; seat < 2; ++seat) move(world, seat, kBesideOnTop_m[static_cast<std::size_t>(seat)] + at_m);
  }
}

TEST(CorotationalTissueWorld, TwoProbesBarelyPressedFeelWhatTheyFeelOfLinearTissue) {
  const CorotationalTissue tissue = compressible_block();
  CorotationalTissueWorld world(tissue, 2);
  TetrahedralMesh mesh(tetrahedra_of(kThinBlock));
  const std::vector<int> held = nodes_below(mesh, scene::Point::Zero(), scene::Point::UnitZ());
  const TissueModel model(LinearTissue(std::move(mesh), kCompressible, held),
                          {.contact_stiffness_N_per_m = kContact_N_per_m});
  LinearTissueWorld linear(model, 2);
  press(world, 2e-5);
  press(linear, 2e-5);
  for (int seat = 0; seat < 2; ++seat) {
    const scene::Point expected_N = linear.seat(seat).result.force_N;
    EXPECT_GT(expected_N.norm(), 5e-4);
    EXPECT_LT((world.seat(seat).result.force_N - expected_N).norm(), 0.01 * expected_N.norm())
        << world.seat(seat).result.force_N.transpose() << " not " << expected_N.transpose();
  }
}

TEST(CorotationalTissueWorld, OnePressedBesideTheOtherIsFeltUntilItLeaves) {
  const CorotationalTissue tissue = compressible_block();
  CorotationalTissueWorld both(tissue, 2);
  press(both, 0.005);
  const scene::Point beside_N = both.seat(1).result.force_N;
  both.leave(0);
  const scene::Point at_m = kBesideOnTop_m[1] - scene::Point(0, 0, 0.005);
  for (int n = 0; n < 10; ++n) move(both, 1, at_m);
  CorotationalTissueWorld alone(tissue, 2);
  static_cast<void>(alone.join());
  static_cast<void>(alone.join());
  for (int n = 0; n <= 50; ++n) {
    move(alone, 1, kBesideOnTop_m[1] + scene::Point(0, 0, 0.004 - 0.009 * std::min(1.0, n / 40.0)));
  }
  const scene::Point alone_N = alone.seat(1).result.force_N;
  EXPECT_GT((beside_N - alone_N).norm(), 0.02 * alone_N.norm());
  EXPECT_LT((both.seat(1).result.force_N - alone_N).norm(), 0.005 * alone_N.norm()) << "its load has gone with it";
}

TEST(CorotationalTissueWorld, WhatOneFeelsOfTheOthersDisplacementIsWhatTheOtherFeelsOfItsOwn) {
  const CorotationalTissue tissue = compressible_block();
  CorotationalTissueWorld world(tissue, 2);
  press(world, 0.005);
  constexpr double kStep_m = 1e-5;
  const auto coupling = [&](std::size_t moved, std::size_t felt) {
    std::array<double, 2> force_N{};
    for (const std::size_t side : {0U, 1U}) {
      const scene::Point step_m(0, 0, side == 0 ? -kStep_m : kStep_m);
      for (int n = 0; n < 30; ++n) {
        move(world, static_cast<int>(moved), kBesideOnTop_m[moved] + step_m - scene::Point(0, 0, 0.005));
        force_N[side] =
            move(world, static_cast<int>(felt), kBesideOnTop_m[felt] - scene::Point(0, 0, 0.005)).force_N.z();
      }
    }
    return (force_N[1] - force_N[0]) / (2 * kStep_m);
  };
  const double there_N_per_m = coupling(0, 1);
  const double back_N_per_m = coupling(1, 0);
  EXPECT_GT(std::abs(there_N_per_m), 0.5);
  EXPECT_NEAR(there_N_per_m / back_N_per_m, 1, 0.01);
}

struct HandsWork {
  double lost = 0;        // when both are out again, as a share of the most that was stored
  double least_left = 0;  // of it at any time, beside what was stored
};

/// Both go round on closed ways, by turns; their work by the trapezoidal rule over the forces that they were given.
HandsWork two_hands_go_round(const CorotationalTissue& tissue, double depth_m, int steps) {
  CorotationalTissueWorld world(tissue, 2);
  while (world.join() >= 0) continue;
  std::array<scene::Point, 2> before_m{scene::Point::Zero(), scene::Point::Zero()};
  std::array<scene::Point, 2> before_N{scene::Point::Zero(), scene::Point::Zero()};
  double work_J = 0;
  double least_left_J = 0;
  double peak_J = 0;
  for (int n = 0; n <= steps; ++n) {
    for (const std::size_t seat : {0U, 1U}) {
      const double angle = 2 * std::numbers::pi * n / steps - 0.4 * static_cast<double>(seat);
      const scene::Point at_m =
          kBesideOnTop_m[seat] + scene::Point(0.004 * std::sin(angle), 0.003 * std::sin(2 * angle),
                                              0.002 - (0.002 + depth_m) * 0.5 * (1 - std::cos(angle)));
      const TissueResult& result = move(world, static_cast<int>(seat), at_m);
      EXPECT_TRUE(result.finite);
      if (n > 0) work_J -= 0.5 * (result.force_N + before_N[seat]).dot(at_m - before_m[seat]);
      peak_J = std::max(peak_J, result.energy_J);
      least_left_J = std::min(least_left_J, work_J - result.energy_J);
      before_m[seat] = at_m;
      before_N[seat] = result.force_N;
    }
  }
  EXPECT_GT(peak_J, 1e-4);
  return {.lost = work_J / peak_J, .least_left = least_left_J / peak_J};
}

TEST(CorotationalTissueWorld, ReturnsToTwoHandsWhatTheyGave) {
  const HandsWork work = two_hands_go_round(compressible_block(), 0.003, 800);
  EXPECT_GT(work.least_left, -1e-4);
  // That each knows where the other was a motion before costs a share that falls with the step.
  EXPECT_GT(work.lost, 0);
  EXPECT_LT(work.lost, 0.01);
}

TEST(CorotationalTissueWorld, LosesNoMoreByLaggingWhereDeepPointsSlipOffFolds) {
  // More than half a cell deep, points catch at folds between cells; slipping off takes half of the energy, at steps of
  // any length.
  const HandsWork lagging = two_hands_go_round(compressible_block(), 0.006, 200);
  CorotationalOptions thorough = kUsual;
  thorough.iterations_max = 60;
  thorough.linear_iterations_max = 200;
  const HandsWork settled = two_hands_go_round(compressible_block(thorough), 0.006, 200);
  EXPECT_GT(lagging.least_left, -1e-3);
  EXPECT_GT(settled.least_left, -1e-3);
  EXPECT_NEAR(lagging.lost, settled.lost, 0.05);
}

TEST(CorotationalTissueWorld, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const CorotationalTissue tissue = compressible_block();
  CorotationalTissueWorld world(tissue, 2);
  const test::AllocationGuard guard;
  press(world, 0.005);
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_GT(world.seat(1).result.contacts, 0);
}

TEST(CorotationalTissueWorld, IsSeenAsItIsDeformed) {
  const CorotationalTissue tissue = compressible_block();
  CorotationalTissueWorld world(tissue, 2);
  const std::vector<scene::VisiblePart> parts = world.visible();
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].triangles.size(), tissue.mesh().triangles().size());
  std::vector<float> seen(3 * parts[0].vertices_m.size());
  const auto most_moved_m = [&] {
    EXPECT_EQ(world.sample(0, seen), seen.size());
    double most_m = 0;
    for (std::size_t i = 0; i < parts[0].vertices_m.size(); ++i) {
      const scene::Point now_m(seen[3 * i], seen[3 * i + 1], seen[3 * i + 2]);
      most_m = std::max(most_m, (now_m - parts[0].vertices_m[i]).norm());
    }
    return most_m;
  };
  EXPECT_LT(most_moved_m(), 1e-7);
  press(world, 1e-3);
  EXPECT_GT(most_moved_m(), 1e-4);
  EXPECT_LT(most_moved_m(), 2e-3);
  EXPECT_EQ(world.sample(parts[0].vertices_m.size(), seen), 0U);
}

}  // namespace
}  // namespace forcebound::tissue
