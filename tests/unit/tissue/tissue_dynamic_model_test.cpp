#include "forcebound/tissue/tissue_dynamic_model.hpp"

#include <gmock/gmock.h>

#include <Eigen/LU>

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/tissue_block.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::tissue {
namespace {

using test::kThickTop_m;
using testing::Contains;
using testing::HasSubstr;

const ProbeOptions kTied{.contact_stiffness_N_per_m = 1e3};

TissueDescription block_description() {
  TetrahedralMesh mesh(test::tetrahedra_of(test::kThickBlock));
  std::vector<int> held = nodes_below(mesh, scene::Point::Zero(), scene::Point::UnitZ());
  return {.mesh = std::move(mesh), .material = test::kSoft, .held_nodes = std::move(held)};
}

TissueDynamicModel block(const ProbeOptions& probe, bool large_motion = false) {
  TissueDescription description = block_description();
  description.probe = probe;
  description.large_motion = large_motion;
  return TissueDynamicModel(std::move(description));
}

/// The laws, each in a block of its own.
std::vector<TissueDynamicModel> blocks() {
  std::vector<TissueDynamicModel> dynamic_models;
  dynamic_models.push_back(block({.radius_m = 0}));
  dynamic_models.push_back(block({.radius_m = 0.01}));
  dynamic_models.push_back(block(kTied, true));
  dynamic_models.push_back(block({.radius_m = 0.01}, true));
  return dynamic_models;
}

scene::ModelTouch go(scene::DynamicModelState& state, int seat, const scene::Point& from_m, const scene::Point& to_m,
                     int steps = 30) {
  for (int n = 0; n <= steps; ++n) {
    state.move(seat, from_m + (to_m - from_m) * n / steps, scene::Point::Zero());
    state.advance(1e-3);
  }
  return state.touch(seat);
}

TEST(TissueDynamicModel, IsFeltWhereItsFactsSaySurfaceIs) {
  const std::array<double, 4> radius_m{0, 0.01, 0, 0.01};
  std::size_t law = 0;
  for (const TissueDynamicModel& dynamic_model : blocks()) {
    SCOPED_TRACE(law);
    const scene::Point surface_m = dynamic_model.facts().on_surface_m;
    EXPECT_LT((surface_m - scene::Point(0.03, 0.03, kThickTop_m + radius_m[law++])).norm(), 1e-9);
    const auto state = dynamic_model.make_state(1);
    const int seat = state->join();
    EXPECT_EQ(state->touch(seat).force_N, scene::Point::Zero());
    const scene::ModelTouch above =
        go(*state, seat, surface_m + scene::Point(0, 0, 0.03), surface_m + scene::Point(0, 0, 0.0001));
    EXPECT_EQ(above.force_N, scene::Point::Zero());
    EXPECT_FALSE(above.penetration_m > 0);
    const scene::ModelTouch within =
        go(*state, seat, surface_m + scene::Point(0, 0, 0.0001), surface_m - scene::Point(0, 0, 0.002));
    EXPECT_GT(within.force_N.z(), 0.01);
    EXPECT_GT(within.normal.z(), 0.99);
    EXPECT_GT(within.penetration_m, 0.0019);
    EXPECT_TRUE(state->sound());
  }
}

TEST(TissueDynamicModel, TimeDoesNotMatter) {
  for (const TissueDynamicModel& dynamic_model : blocks()) {
    const auto slow = dynamic_model.make_state(1);
    const auto fast = dynamic_model.make_state(1);
    const int slow_seat = slow->join();
    const int fast_seat = fast->join();
    for (int n = 0; n <= 20; ++n) {
      const scene::Point at_m(0.03, 0.031, kThickTop_m + 0.012 - 0.001 * n);
      slow->move(slow_seat, at_m, scene::Point(0, 0, -1));
      slow->advance(1);
      fast->move(fast_seat, at_m, scene::Point(0, 0, -1000));
      fast->advance(1e-6);
      EXPECT_EQ(slow->touch(slow_seat).force_N, fast->touch(fast_seat).force_N);
    }
    EXPECT_GT(slow->touch(slow_seat).force_N.z(), 0.01);
  }
}

TEST(TissueDynamicModel, FactsSayWhatItConsistsOf) {
  const auto dynamic_models = blocks();
  const scene::DynamicModelFacts linear = dynamic_models[0].facts();
  EXPECT_THAT(linear.lines, Contains("196 nodes, 108 boxes, 146 nodes on the surface, 49 held"));
  EXPECT_THAT(linear.lines, Contains("elastic: Young's modulus 5000 Pa, Poisson's ratio 0.4"));
  EXPECT_THAT(linear.lines, Contains("linear: small displacements and rotations, no inertia"));
  EXPECT_THAT(linear.lines, Contains(HasSubstr("felt by a point, a contact of 1e+05 N/m")));
  EXPECT_FALSE(linear.inputs.velocity || linear.inputs.time) << "quasi-static";
  EXPECT_GT(linear.memory_bytes, 146U * 146U * 72U);
  EXPECT_GT(linear.state_bytes, sizeof(TissueState));
  EXPECT_THAT(dynamic_models[1].facts().lines,
              Contains(HasSubstr("felt by a sphere of 0.01 m, at most 8 contacts of 1e+05")));
  EXPECT_GT(dynamic_models[1].facts().cost_ns, 5 * linear.cost_ns);
  EXPECT_THAT(dynamic_models[2].facts().lines, Contains(HasSubstr("corotational: large motion")));
  EXPECT_EQ(dynamic_models[2].facts().stiffness_N_per_m, 1e3);
  EXPECT_GT(dynamic_models[2].facts().memory_bytes, 100U * 648U);
  EXPECT_THAT(dynamic_models[3].facts().lines, Contains(HasSubstr("felt by a sphere of 0.01 m through a skin of")));
  EXPECT_GT(dynamic_models[3].facts().stiffness_N_per_m, 1e3);
  EXPECT_GT(dynamic_models[3].facts().cost_ns, dynamic_models[2].facts().cost_ns);
}

TEST(TissueDynamicModel, OneSeatHasNothingOfWhatOthersWouldNeed) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const TissueDynamicModel dynamic_model = block({});
  const auto heap_operations = [&](int seats) {
    const test::AllocationGuard guard;
    const auto state = dynamic_model.make_state(seats);
    return guard.heap_operations();
  };
  EXPECT_EQ(heap_operations(1), 2U) << "itself and its seat";
  EXPECT_GT(heap_operations(2), heap_operations(1));
  EXPECT_LT(dynamic_model.facts().state_bytes, 2000U);
}

TEST(TissueDynamicModel, StiffnessIsThatOfTheStiffestPlaceThatCanBeTouched) {
  EXPECT_EQ(block({}).facts().stiffness_N_per_m, 1e5) << "held nodes are on the surface, and give way nowhere";
  // Held within, where no probe comes: tissue and contact in series.
  TissueDescription inside = block_description();
  inside.held_nodes = nodes_in_box(inside.mesh, {0.03, 0.03, 0.015}, {0.021, 0.021, 0.011});
  const double contact_N_per_m = inside.probe.contact_stiffness_N_per_m;
  const LinearTissue tissue(inside.mesh, inside.material, inside.held_nodes);
  const double stiffness_N_per_m = TissueDynamicModel(std::move(inside)).facts().stiffness_N_per_m;
  double stiffest_N_per_m = 0;
  for (int node = 0; node < tissue.surface_nodes(); ++node) {
    const Eigen::Matrix3d yields =
        tissue.compliance_m_per_N(node, node) + 1 / contact_N_per_m * Eigen::Matrix3d::Identity();
    // The longest of what unit motions take, by the power method.
    scene::Point along = scene::Point(1, 0.9, 0.8);
    for (int n = 0; n < 200; ++n) along = yields.inverse() * along.normalized();
    stiffest_N_per_m = std::max(stiffest_N_per_m, along.norm());
  }
  EXPECT_LT(stiffness_N_per_m, 1e4);
  EXPECT_NEAR(stiffness_N_per_m / stiffest_N_per_m, 1, 1e-6);
}

TEST(TissueDynamicModel, SaysHowCoarseTheMeshIsForItsContact) {
  EXPECT_THAT(
      block({.radius_m = 0.01}).facts().lines,
      Contains("the mesh makes a sphere half its radius deep about 47 % too stiff: edges of its surface are 11 mm "
               "long, 5.3 mm would make it 10 %"));
  EXPECT_THAT(
      block({.radius_m = 0.04}).facts().lines,
      Contains("the mesh makes a sphere half its radius deep about 2.9 % too stiff: edges of its surface are 11 mm "
               "long"));
}

TEST(TissueDynamicModel, CountsWhatItCouldNotDo) {
  const TissueDynamicModel dynamic_model = block({.radius_m = 0.02, .contacts_max = 2});
  const auto state = dynamic_model.make_state(1);
  const int seat = state->join();
  const scene::Point on_top_m = dynamic_model.facts().on_surface_m;
  static_cast<void>(go(*state, seat, on_top_m + scene::Point(0, 0, 0.001), on_top_m));
  EXPECT_EQ(state->faults().contacts_left_out, 0U);
  static_cast<void>(go(*state, seat, on_top_m, on_top_m - scene::Point(0, 0, 0.004)));
  EXPECT_GT(state->faults().contacts_left_out, 0U);
  EXPECT_GT(state->faults().not_converged, 0U);
}

TEST(TissueDynamicModel, InvalidMotionsOfAnUntrustedClientBreakNothing) {
  for (const TissueDynamicModel& dynamic_model : blocks()) {
    const auto state = dynamic_model.make_state(2);
    const int seat = state->join();
    const int untrusted = state->join();
    const scene::Point surface_m = dynamic_model.facts().on_surface_m;
    static_cast<void>(go(*state, seat, surface_m + scene::Point(0, 0, 0.03), surface_m - scene::Point(0, 0, 0.001)));
    for (const double far_m : {1e300, -1e300, 1e3, -1e3}) {
      state->move(untrusted, {far_m, -far_m, far_m}, {far_m, far_m, far_m});
      EXPECT_TRUE(state->touch(untrusted).force_N.allFinite());
    }
    state->leave(untrusted);
    EXPECT_GT(go(*state, seat, surface_m + scene::Point(0, 0, 0.03), surface_m - scene::Point(0, 0, 0.001)).force_N.z(),
              0.01);
    EXPECT_TRUE(state->sound());
  }
}

TEST(TissueDynamicModel, HasAsManySeatsAsItWasTold) {
  for (const TissueDynamicModel& dynamic_model : blocks()) {
    const auto state = dynamic_model.make_state(3);
    for (int seat = 0; seat < 3; ++seat) EXPECT_EQ(state->join(), seat);
    EXPECT_EQ(state->join(), -1);
    state->leave(1);
    EXPECT_EQ(state->join(), 1);
    EXPECT_EQ(state->join(), -1);
    EXPECT_THROW(static_cast<void>(dynamic_model.make_state(0)), std::invalid_argument);
  }
}

TEST(TissueDynamicModel, RefusesInvalidSettings) {
  const auto refusal = [](const ProbeOptions& probe, bool large_motion) -> std::string {
    try {
      static_cast<void>(block(probe, large_motion));
    } catch (const std::exception& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(refusal({.radius_m = 0.001}, true), HasSubstr("block: a sphere of radius 0.001 m is too small"));
  EXPECT_EQ(refusal({.radius_m = -1}, false), "radius_m must be >= 0, got -1");
  EXPECT_EQ(refusal({}, true), "contact_stiffness_N_per_m must be > 0 and <= 10000 under large motion, got 1e+05");
  EXPECT_EQ(refusal({.contacts_max = 0}, true), "contacts_max must be from 1 to 16, got 0");
  EXPECT_THAT(refusal({.radius_m = 0.001}, false), HasSubstr("block: a sphere of radius 0.001 m is too small"));
  TissueDescription loose = block_description();
  loose.held_nodes = {};
  EXPECT_THROW(TissueDynamicModel(std::move(loose)), std::runtime_error);
}

TEST(TissueDynamicModel, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const TissueDynamicModel& dynamic_model : blocks()) {
    const auto state = dynamic_model.make_state(2);
    const int seat = state->join();
    const int other = state->join();
    const scene::Point surface_m = dynamic_model.facts().on_surface_m;
    const test::AllocationGuard guard;
    static_cast<void>(
        go(*state, other, surface_m + scene::Point(0.01, 0, 0.03), surface_m + scene::Point(0.01, 0, -0.002)));
    const scene::ModelTouch touch =
        go(*state, seat, surface_m + scene::Point(0, 0, 0.03), surface_m - scene::Point(0, 0, 0.004));
    EXPECT_EQ(guard.heap_operations(), 0U);
    EXPECT_GT(touch.penetration_m, 0);
  }
}

TEST(TissueDynamicModel, TheLiverPushesBack) {
  const auto path = recorded_data("meshes/liver.msh");
  if (!path) GTEST_SKIP() << "meshes/liver.msh is not there";
  for (const bool large_motion : {false, true}) {
    TetrahedralMesh mesh(load_gmsh(path->string()), {.scale = 0.01});
    std::vector<int> held = nodes_below(mesh, {0, 0, 0}, scene::Point::UnitZ());
    ASSERT_FALSE(held.empty());
    const TissueDynamicModel dynamic_model({.mesh = std::move(mesh),
                                            .material = test::kSoft,
                                            .held_nodes = std::move(held),
                                            .probe = kTied,
                                            .large_motion = large_motion});
    const scene::Point surface_m = dynamic_model.facts().on_surface_m;
    const auto state = dynamic_model.make_state(1);
    const int seat = state->join();
    const scene::ModelTouch touch =
        go(*state, seat, surface_m + scene::Point(0, 0, 0.005), surface_m - scene::Point(0, 0, 0.005));
    EXPECT_GT(touch.force_N.z(), 0.01);
    EXPECT_TRUE(state->sound());
  }
}

}  // namespace
}  // namespace forcebound::tissue
