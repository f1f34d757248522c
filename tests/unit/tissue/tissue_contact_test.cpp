#include "forcebound/tissue/tissue_contact.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/tissue_block.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::tissue {
namespace {

using test::kSoft;
using test::kThickBlock;
using test::kThickTop_m;
using test::tetrahedra_of;

TissueModel block_model(const ProbeOptions& options) {
  TetrahedralMesh mesh(tetrahedra_of(kThickBlock));
  const std::vector<int> held = nodes_below(mesh, scene::Point::Zero(), scene::Point::UnitZ());
  return {LinearTissue(std::move(mesh), kSoft, held), options};
}

/// 20 mm square and 2.5 mm thick, held at its rim.
TissueModel sheet_model(const ProbeOptions& options) {
  TetrahedralMesh mesh(tetrahedra_of({.cubes = {8, 8, 1}, .cube_m = 0.0025}));
  std::vector<int> held;
  for (int node = 0; node < static_cast<int>(mesh.nodes_m().size()); ++node) {
    const scene::Point& at = mesh.nodes_m()[node];
    if (std::min(at.x(), at.y()) < 1e-6 || std::max(at.x(), at.y()) > 0.02 - 1e-6) held.push_back(node);
  }
  return {LinearTissue(std::move(mesh), kSoft, held), options};
}

/// Steps along a straight line and says what the last step said.
TissueResult go(const TissueModel& model, TissueState& state, const scene::Point& from, const scene::Point& to,
                int steps) {
  TissueResult result;
  for (int n = 0; n <= steps; ++n) result = model.step(state, from + (to - from) * n / steps);
  return result;
}

std::vector<ProbeOptions> probes() { return {{.radius_m = 0}, {.radius_m = 0.005}, {.radius_m = 0.01}}; }

TEST(TissueModel, FeelsNothingOutside) {
  for (const ProbeOptions& options : probes()) {
    const TissueModel model = block_model(options);
    for (const scene::Point& at : {scene::Point(0.03, 0.03, 0.0301 + options.radius_m), scene::Point(1, 1, 1),
                                   scene::Point(-0.02, 0.03, 0.01)}) {
      TissueState state{};
      const TissueResult result = model.step(state, at);
      EXPECT_EQ(result.force_N, scene::Point::Zero());
      EXPECT_EQ(result.contacts, 0);
      EXPECT_TRUE(result.converged && result.finite);
    }
  }
}

TEST(TissueModel, PushesOutwardAndMoreTheDeeper) {
  for (const ProbeOptions& options : probes()) {
    const TissueModel model = block_model(options);
    TissueState state{};
    double last_N = 0;
    for (int n = 1; n <= 10; ++n) {
      const double depth_m = 0.0005 * n;
      const TissueResult result = go(model, state, {0.032, 0.031, kThickTop_m + options.radius_m - depth_m + 0.0005},
                                     {0.032, 0.031, kThickTop_m + options.radius_m - depth_m}, 5);
      EXPECT_GT(result.force_N.z(), last_N);
      EXPECT_NEAR(result.depth_m, depth_m, options.radius_m / 24 + 1e-12);
      EXPECT_GT(result.normal.z(), 0.8);
      EXPECT_TRUE(result.converged);
      last_N = result.force_N.z();
    }
  }
}

TEST(TissueModel, WhereTheTissueIsHeldOnlyTheContactYields) {
  const TissueModel model = block_model({.contact_stiffness_N_per_m = 2000});
  TissueState state{};
  const TissueResult result = go(model, state, {0.021, 0.033, -0.001}, {0.021, 0.034, 0.002}, 30);
  EXPECT_LT((result.force_N - scene::Point(0, 0, -4)).norm(), 1e-9);
  EXPECT_NEAR(result.energy_J, 0.5 * 2000 * 0.002 * 0.002, 1e-12);
}

TEST(TissueModel, ASphereOnOneNodeFeelsThatNodesCompliance) {
  const TissueModel model = block_model({.radius_m = 0.01, .contact_stiffness_N_per_m = 1e4});
  const LinearTissue& tissue = model.tissue();
  int node = 0;
  while ((tissue.surface().nodes_m()[node] - scene::Point(0.03, 0.03, kThickTop_m)).norm() > 1e-9) ++node;
  TissueState state{};
  constexpr double kDepth_m = 1e-5;
  const TissueResult result = go(model, state, {0.03, 0.03, 0.041}, {0.03, 0.03, 0.04 - kDepth_m}, 20);
  EXPECT_EQ(result.contacts, 1);
  const double compliance = tissue.compliance_m_per_N(node, node)(2, 2) + 1e-4;
  EXPECT_NEAR(result.force_N.z() / (kDepth_m / compliance), 1, 1e-9);
  EXPECT_LT(result.force_N.head<2>().norm(), 1e-12);
}

TEST(TissueModel, ForceIsTheGradientOfItsEnergy) {
  for (const ProbeOptions& options : probes()) {
    SCOPED_TRACE(options.radius_m);
    const TissueModel model = block_model(options);
    TissueState state{};
    const scene::Point at(0.0243, 0.0332, kThickTop_m + options.radius_m - 0.004);
    const TissueResult result = go(model, state, at + scene::Point(0.002, 0.001, 0.006), at, 60);
    scene::Point gradient;
    for (int axis = 0; axis < 3; ++axis) {
      constexpr double kStep_m = 1e-7;
      const auto energy_J = [&](double step_m) {
        TissueState copy = state;
        return model.step(copy, at + step_m * scene::Point::Unit(axis)).energy_J;
      };
      gradient[axis] = (energy_J(kStep_m) - energy_J(-kStep_m)) / (2 * kStep_m);
    }
    EXPECT_LT((result.force_N + gradient).norm(), 1e-5 * result.force_N.norm());
  }
}

TEST(TissueModel, ForceOnAPointIsNormalToTheSurfaceAsItIsDeformed) {
  const TissueModel model = block_model({});
  const LinearTissue& tissue = model.tissue();
  TissueState state{};
  const TissueResult result = go(model, state, {0.0243, 0.0332, 0.031}, {0.0243, 0.0332, 0.029}, 50);
  ASSERT_EQ(state.contacts, 1U);
  ASSERT_GT(*std::ranges::min_element(state.contact[0].weight), 0.01) << "within a triangle";
  const auto& nodes = tissue.surface().triangles()[static_cast<std::size_t>(state.contact[0].triangle)];
  Eigen::Matrix3d corners;
  for (int corner = 0; corner < 3; ++corner) {
    scene::Point moved = tissue.surface().nodes_m()[nodes[corner]];
    for (std::size_t a = 0; a < 3; ++a) {
      moved -= tissue.compliance_m_per_N(nodes[corner], nodes[a]) * (state.contact[0].weight[a] * result.force_N);
    }
    corners.col(corner) = moved;
  }
  for (int corner = 1; corner < 3; ++corner) {
    const scene::Point edge = (corners.col(corner) - corners.col(0)).normalized();
    EXPECT_LT(std::abs(edge.dot(result.normal)), 1e-4);
  }
  EXPECT_GT(std::abs(result.normal.x()) + std::abs(result.normal.y()), 1e-3) << "the surface is tilted there";
}

struct Loop {
  double work_J = 0;  // by the hand, on the tissue
  double peak_J = 0;
};

// Down, around and up again; the hand's work by the trapezoidal rule.
Loop go_round(const TissueModel& model, double depth_m, int steps) {
  const double radius_m = model.options().radius_m;
  TissueState state{};
  TissueResult last;
  scene::Point before = scene::Point::Zero();
  Loop loop;
  for (int n = 0; n <= steps; ++n) {
    const double angle = 2 * std::numbers::pi * n / steps;
    const scene::Point at(0.0213 + 0.015 * std::sin(angle), 0.0334 + 0.004 * std::sin(2 * angle),
                          kThickTop_m + radius_m + 0.002 - (depth_m + 0.002) * 0.5 * (1 - std::cos(angle)));
    const TissueResult result = model.step(state, at);
    EXPECT_EQ(result.contacts_left_out, 0);
    if (n > 0) loop.work_J -= 0.5 * (result.force_N + last.force_N).dot(at - before);
    loop.peak_J = std::max(loop.peak_J, result.energy_J);
    last = result;
    before = at;
  }
  return loop;
}

TEST(TissueModel, AClosedLoopTakesWhatItReturns) {
  for (ProbeOptions options : probes()) {
    // So that no slide ends before its place, which would lose energy.
    options.iterations_max = 200;
    for (const double depth_m : {0.001, 0.003}) {
      SCOPED_TRACE(testing::Message() << "radius " << options.radius_m << " m, depth " << depth_m << " m");
      const Loop loop = go_round(block_model(options), depth_m, 4000);
      EXPECT_GT(loop.peak_J, 1e-5);
      // What the trapezoidal rule makes of 4000 steps, and of kinks where contacts begin.
      EXPECT_NEAR(loop.work_J, 0, 3e-4 * loop.peak_J);
    }
  }
}

TEST(TissueModel, APointWhoseSlidesEndEarlyLosesLessTheSlowerItMoves) {
  const TissueModel model = block_model({});
  const Loop loop = go_round(model, 0.003, 4000);
  const Loop slower = go_round(model, 0.003, 16000);
  EXPECT_GT(loop.work_J, 0);
  EXPECT_LT(loop.work_J, 2e-3 * loop.peak_J);
  EXPECT_LT(slower.work_J, 0.35 * loop.work_J);
}

TEST(TissueModel, APointNeverReturnsMoreThanItTookAlsoWhereItSlipsOff) {
  const TissueModel model = block_model({});
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> in_block_m(-0.01, 0.07);
    TissueState state{};
    TissueResult last;
    scene::Point before(0.03, 0.03, 0.04);
    scene::Point target = before;
    double work_J = 0;
    double peak_J = 0;
    for (int n = 0; n < 60000; ++n) {
      if (n % 2000 == 0) target = {in_block_m(random), in_block_m(random), 0.5 * in_block_m(random)};
      const scene::Point at = before + 0.002 * (target - before);
      const TissueResult result = model.step(state, at);
      // What a step takes on its way in, it takes before there is a force: as at any sampled wall.
      if (last.contacts == 0) work_J += result.energy_J - 0.5 * (last.force_N - result.force_N).dot(at - before);
      // What a step takes on its way in, it takes before there is a force: as at any sampled wall.
      work_J += last.contacts == 0 ? result.energy_J : -0.5 * (result.force_N + last.force_N).dot(at - before);
      peak_J = std::max(peak_J, result.energy_J);
      EXPECT_GE(work_J, result.energy_J - 2e-3 * std::max(peak_J, 1e-3));
      last = result;
      before = at;
    }
    EXPECT_GT(peak_J, 1e-3);
  }
}

TEST(TissueModel, DoesNotPopThroughThinTissue) {
  for (const double radius_m : {0.0, 0.002}) {
    for (const double step_m : {1e-4, 1e-3}) {
      SCOPED_TRACE(testing::Message() << "radius " << radius_m << " m, steps of " << step_m << " m");
      const TissueModel model = sheet_model({.radius_m = radius_m, .contacts_max = 16});
      TissueState state{};
      double last_N = 0;
      for (double z = 0.0035 + radius_m; z > 0.0025 + radius_m - 0.005; z -= step_m) {
        const TissueResult result = model.step(state, {0.0101, 0.0098, z});
        EXPECT_GE(result.force_N.z(), last_N - 1e-9) << "at " << z;
        last_N = result.force_N.z();
      }
      EXPECT_GT(last_N, 0.005);
    }
  }
}

TEST(TissueModel, AStateThatStartsInsideIsPushedOutWhereTheSurfaceIsNearest) {
  for (const ProbeOptions& options : probes()) {
    const TissueModel model = block_model(options);
    TissueState state{};
    const TissueResult result = model.step(state, {0.0312, 0.0284, kThickTop_m - 0.002});
    EXPECT_GT(result.normal.z(), 0.9);
    EXPECT_GT(result.contacts, 0);
  }
}

TEST(TissueModel, ReportsContactsBeyondItsCapacity) {
  const scene::Point at(0.031, 0.029, kThickTop_m + 0.02 - 0.004);
  TissueState state{};
  const TissueResult whole =
      go(block_model({.radius_m = 0.02, .contacts_max = 16}), state, at + scene::Point(0, 0, 0.005), at, 50);
  EXPECT_GT(whole.contacts, 2);
  EXPECT_EQ(whole.contacts_left_out, 0);
  EXPECT_TRUE(whole.converged);
  state = {};
  const TissueResult cut =
      go(block_model({.radius_m = 0.02, .contacts_max = 2}), state, at + scene::Point(0, 0, 0.005), at, 50);
  EXPECT_EQ(cut.contacts, 2);
  EXPECT_GT(cut.contacts_left_out, 0);
  EXPECT_FALSE(cut.converged);
  EXPECT_GT(cut.residual_m, 0);
  EXPECT_LT(cut.energy_J, whole.energy_J);
}

TEST(TissueModel, ReportsTheResidualOfAnExhaustedBudget) {
  const scene::Point at(0.031, 0.029, kThickTop_m + 0.01 - 0.004);
  double last_J = 0;
  for (const int iterations : {1, 2, 4, 40}) {
    TissueState state{};
    const TissueResult result =
        block_model({.radius_m = 0.01, .contacts_max = 16, .iterations_max = iterations}).step(state, at);
    EXPECT_LE(result.iterations, iterations);
    EXPECT_TRUE(result.force_N.allFinite());
    EXPECT_EQ(result.converged, iterations == 40);
    EXPECT_EQ(result.residual_m > 1e-8, iterations != 40) << result.residual_m;
    EXPECT_GE(result.energy_J, last_J) << "each iteration is a better bound from below";
    last_J = result.energy_J;
  }
}

TEST(TissueModel, LeavesItsStateAloneWhereThePositionIsNotFinite) {
  for (const ProbeOptions& options : probes()) {
    const TissueModel model = block_model(options);
    TissueState state{};
    static_cast<void>(model.step(state, {0.03, 0.03, kThickTop_m - 0.001}));
    const TissueState before = state;
    for (const double wrong : {std::nan(""), std::numeric_limits<double>::infinity()}) {
      const TissueResult result = model.step(state, {0.03, wrong, 0.02});
      EXPECT_FALSE(result.finite);
      EXPECT_EQ(result.force_N, scene::Point::Zero());
      EXPECT_EQ(std::memcmp(&state, &before, sizeof state), 0);
    }
    EXPECT_TRUE(model.step(state, {1e300, -1e300, 1e300}).force_N.allFinite());
  }
}

TEST(TissueModel, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const ProbeOptions& options : probes()) {
    const TissueModel model = block_model(options);
    TissueState state{};
    const test::AllocationGuard guard;
    const TissueResult result = go(model, state, {0.03, 0.02, 0.05}, {0.02, 0.03, 0.025}, 100);
    EXPECT_EQ(guard.heap_operations(), 0U);
    EXPECT_GT(result.contacts, 0);
  }
}

TEST(TissueModel, RefusesOptionsThatNoProbeHas) {
  const auto refusal = [](const ProbeOptions& options) -> std::string {
    try {
      options.check();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal({}), "accepted");
  EXPECT_EQ(refusal({.radius_m = -1}), "radius_m must be >= 0, got -1");
  EXPECT_EQ(refusal({.contact_stiffness_N_per_m = 0}), "contact_stiffness_N_per_m must be > 0, got 0");
  EXPECT_EQ(refusal({.contacts_max = 17}), "contacts_max must be from 1 to 16, got 17");
  EXPECT_EQ(refusal({.iterations_max = 0}), "iterations_max must be >= 1, got 0");
  EXPECT_EQ(refusal({.tolerance = 0}), "tolerance must be > 0 and < 1, got 0");
}

TEST(TissueModel, RefusesASphereTooSmallForTheTriangles) {
  try {
    static_cast<void>(block_model({.radius_m = 0.001}));
    ADD_FAILURE() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("block: a sphere of radius 0.001 m is too small beside edges of "));
  }
}

TEST(TissueModel, TheLiverIsFelt) {
  const auto path = recorded_data("meshes/liver.msh");
  if (!path) GTEST_SKIP() << "meshes/liver.msh is not there";
  TetrahedralMesh mesh(load_gmsh(path->string()), {.scale = 0.01});
  const std::vector<int> held = nodes_below(mesh, {0, 0, 0}, scene::Point::UnitZ());
  const LinearTissue tissue(std::move(mesh), kSoft, held);
  for (const double radius_m : {0.0, 0.01}) {
    const TissueModel model(tissue, {.radius_m = radius_m, .contacts_max = 16});
    for (int t = 0; t < static_cast<int>(tissue.surface().triangles().size()); t += 7) {
      const scene::Point middle = tissue.surface().at({.triangle = t, .weight = scene::Point::Constant(1.0 / 3)});
      const scene::Point out = tissue.surface().triangle_normal(t);
      TissueState state{};
      const TissueResult result =
          go(model, state, middle + (radius_m + 0.002) * out, middle + (radius_m - 0.001) * out, 30);
      EXPECT_GT(result.contacts, 0) << t;
      EXPECT_GT(result.force_N.dot(out), 0) << t;
      EXPECT_TRUE(result.finite) << t;
      EXPECT_EQ(result.converged, result.contacts_left_out == 0) << t;
    }
  }
}

}  // namespace
}  // namespace forcebound::tissue
