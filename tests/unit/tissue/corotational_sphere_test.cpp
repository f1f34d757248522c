#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>
#include <random>
#include <vector>

#include "forcebound/tissue/corotational_tissue.hpp"
#include "forcebound/tissue/linear_tissue.hpp"
#include "forcebound/tissue/tissue_world.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/felt_tissue.hpp"
#include "tests/support/tissue_block.hpp"

namespace forcebound::tissue {
namespace {

using test::kSoft;
using test::kThinTop_m;
using Felt = test::FeltTissue;

constexpr double kProbeRadius_m = 0.008;

CorotationalOptions patient(double radius_m) {
  return {.radius_m = radius_m, .iterations_max = 60, .linear_iterations_max = 400, .tolerance = 1e-7};
}

CorotationalTissue tissue_of(const TetrahedralSoup& soup, const CorotationalOptions& options,
                             const scene::Point& up = scene::Point::UnitZ()) {
  TetrahedralMesh mesh(soup);
  const std::vector<int> held = nodes_below(mesh, scene::Point::Zero(), up);
  return {std::move(mesh), kSoft, held, options};
}

/// 40 x 40 x 20 mm, on a bed.
CorotationalTissue pad(const CorotationalOptions& options) {
  return tissue_of(test::tetrahedra_of(test::kThinBlock), options);
}

/// The sphere's centre, at a depth.
scene::Point over(double x_m, double y_m, double depth_m, double radius_m = kProbeRadius_m) {
  return {x_m, y_m, kThinTop_m + radius_m - depth_m};
}

TEST(CorotationalSphere, BarelyPressedIsFeltAsBesideLinearTissue) {
  constexpr double kBlunt_m = 0.015;
  const CorotationalTissue tissue = pad(
      {.radius_m = kBlunt_m, .contact_stiffness_Pa_per_m = 6e7, .iterations_max = 60, .linear_iterations_max = 400});
  TetrahedralMesh mesh = tissue.mesh();
  const std::vector<int> held = nodes_below(mesh, scene::Point::Zero(), scene::Point::UnitZ());
  const TissueModel linear(LinearTissue(std::move(mesh), kSoft, held), {.radius_m = kBlunt_m, .contacts_max = 16});
  Felt felt(tissue);
  TissueState state{};
  static_cast<void>(linear.step(state, over(0.0213, 0.0178, -0.001, kBlunt_m)));
  for (const double depth_m : {0.002, 0.0025, 0.003}) {
    const TissueResult result = felt.step(over(0.0213, 0.0178, depth_m, kBlunt_m));
    const TissueResult expected = linear.step(state, over(0.0213, 0.0178, depth_m, kBlunt_m));
    EXPECT_TRUE(result.converged) << result.residual_m << " m after " << result.iterations;
    // Less deep, most of the difference would be that the linear law's sphere sinks between its places, 0.2 mm here.
    EXPECT_NEAR(result.force_N.z() / expected.force_N.z(), 1, 0.05) << depth_m;
    EXPECT_NEAR(result.depth_m, depth_m, 0.03 * depth_m);
  }
}

double pressed_N(const CorotationalOptions& options, std::size_t fineness) {
  const test::BlockOfCubes block{.cubes = {2 * fineness, 2 * fineness, fineness},
                                 .cube_m = kThinTop_m / static_cast<double>(fineness)};
  const CorotationalTissue tissue = tissue_of(test::tetrahedra_of(block), options);
  Felt felt(tissue);
  const scene::Point middle(0.02, 0.02, kThinTop_m + options.radius_m);
  const TissueResult result = felt.go(middle + scene::Point(0, 0, 1e-4), middle - scene::Point(0, 0, 0.003), 1);
  EXPECT_TRUE(result.converged) << result.residual_m << " m after " << result.iterations;
  return result.force_N.z();
}

TEST(CorotationalSphere, ForceHasALimitAsCellsGetSmallerWhereThatOfAPointHasNone) {
  constexpr std::array<std::size_t, 3> kFineness{2, 4, 8};
  // What the last is to be multiplied by for the limit, by Aitken's extrapolation.
  const auto limit_share = [&](const CorotationalOptions& options, const char* what) {
    std::array<double, 3> force_N{};
    for (std::size_t level = 0; level < 3; ++level) force_N[level] = pressed_N(options, kFineness[level]);
    const std::array<double, 2> change_N{force_N[0] - force_N[1], force_N[1] - force_N[2]};
    std::cout << what << ": " << force_N[0] << ", " << force_N[1] << ", " << force_N[2] << " N, order "
              << std::log2(change_N[0] / change_N[1]) << "\n";
    EXPECT_GT(change_N[1], 0);
    EXPECT_LT(change_N[1], 0.6 * change_N[0]);
    return 1 - change_N[1] * change_N[1] / ((change_N[0] - change_N[1]) * force_N[2]);
  };
  EXPECT_GT(
      limit_share({.radius_m = 0.016, .iterations_max = 60, .linear_iterations_max = 100, .tolerance = 1e-3}, "sphere"),
      0.7);
  EXPECT_LT(limit_share({.iterations_max = 60, .linear_iterations_max = 100, .tolerance = 1e-3}, "point"), 0.2)
      << "half the cell, half the force";
}

TEST(CorotationalSphere, ForceIsHowSteeplyTheEnergyFalls) {
  const CorotationalTissue tissue = pad(patient(kProbeRadius_m));
  Felt felt(tissue);
  const scene::Point at_m = over(0.0187, 0.0224, 0.004);
  static_cast<void>(felt.go(at_m + scene::Point(0, 0, 0.005), at_m, 5));
  constexpr double kStep_m = 1e-6;
  const scene::Point force_N = felt.step(at_m).force_N;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double before_J = felt.step(at_m - kStep_m * scene::Point::Unit(axis)).energy_J;
    const double after_J = felt.step(at_m + kStep_m * scene::Point::Unit(axis)).energy_J;
    EXPECT_NEAR((before_J - after_J) / (2 * kStep_m), force_N[axis], 1e-3 * force_N.norm()) << axis;
  }
}

TEST(CorotationalSphere, TurnsAndMovesWithTheTissue) {
  const Eigen::Isometry3d turned =
      Eigen::Translation3d(0.3, -0.1, 0.2) * Eigen::AngleAxisd(1.1, scene::Point(1, 2, -2).normalized());
  TetrahedralSoup soup = test::tetrahedra_of(test::kThinBlock);
  const CorotationalTissue upright = tissue_of(soup, patient(kProbeRadius_m));
  for (scene::Point& node : soup.nodes) node = turned * node;
  TetrahedralMesh mesh(soup);
  const std::vector<int> held = nodes_below(mesh, turned.translation() + 1e-9 * turned.linear() * scene::Point::UnitZ(),
                                            turned.linear() * scene::Point::UnitZ());
  const CorotationalTissue tilted(std::move(mesh), kSoft, held, patient(kProbeRadius_m));
  Felt one(upright);
  Felt other(tilted);
  for (const double depth_m : {-0.001, 0.002, 0.006}) {
    const scene::Point at_m = over(0.0187, 0.0224, depth_m);
    const TissueResult straight = one.step(at_m);
    const TissueResult aslant = other.step(turned * at_m);
    EXPECT_LT((aslant.force_N - turned.linear() * straight.force_N).norm(), 1e-4 * straight.force_N.norm() + 1e-12);
    EXPECT_EQ(straight.contacts > 0, depth_m > 0);
  }
}

/// What the hand has done in a round.
struct Round {
  double work_J = 0;        // by the trapezoidal rule over the forces that it was given
  double least_left_J = 0;  // of its work while the body held still in each step, beside what is stored
  double peak_J = 0;
};

/// Pressed in, slid, and let out elsewhere, twice.
std::array<Round, 2> two_rounds(const CorotationalTissue& tissue, int steps) {
  Felt felt(tissue);
  std::array<Round, 2> rounds;
  scene::Point before_m = scene::Point::Zero();
  scene::Point before_N = scene::Point::Zero();
  double while_held_J = 0;
  for (int n = 0; n <= 2 * steps; ++n) {
    const double angle = 2 * std::numbers::pi * n / steps;
    const scene::Point at_m = over(0.02 + 0.006 * std::sin(angle), 0.0187 + 0.004 * std::sin(2 * angle),
                                   0.0025 * (1 - std::cos(angle)) - 0.0005);
    Round& round = rounds.at(n <= steps ? 0 : 1);
    if (n > 0) {
      const DeformedSurface held(tissue.surface(), felt.body.now.displacement_m);
      while_held_J += tissue.pressure()->energy_J(held, at_m) - tissue.pressure()->energy_J(held, before_m);
    }
    const TissueResult result = felt.step(at_m);
    if (n > 0) round.work_J -= 0.5 * (result.force_N + before_N).dot(at_m - before_m);
    round.least_left_J = std::min(round.least_left_J, while_held_J - result.energy_J);
    round.peak_J = std::max(round.peak_J, result.energy_J);
    before_m = at_m;
    before_N = result.force_N;
  }
  return rounds;
}

TEST(CorotationalSphere, NoRoundOfPressingSlidingAndReleasingGivesTheHandEnergy) {
  for (const Round& round : two_rounds(pad({.radius_m = kProbeRadius_m}), 300)) {
    EXPECT_GT(round.peak_J, 2e-4);
    EXPECT_GE(round.least_left_J, -1e-9 * round.peak_J);
    // Nothing is lost, but to the rule.
    EXPECT_NEAR(round.work_J, 0, 1e-4 * round.peak_J);
  }
}

TEST(CorotationalSphere, NoRoundGivesTheHandEnergyWhileTheBodyLags) {
  const CorotationalTissue lagging = pad({.radius_m = kProbeRadius_m, .iterations_max = 1, .linear_iterations_max = 5});
  constexpr int kSteps = 300;
  const auto coarse = two_rounds(lagging, kSteps);
  const auto fine = two_rounds(lagging, 4 * kSteps);
  for (const std::size_t n : {0U, 1U}) {
    EXPECT_GE(coarse.at(n).least_left_J, -1e-9 * coarse.at(n).peak_J);
    // The trapezoidal rule itself gives some, with the square of the step: forces are read after the body gave way.
    EXPECT_NEAR(coarse.at(n).work_J, 0, 3e-3 * coarse.at(n).peak_J);
    EXPECT_LT(std::abs(fine.at(n).work_J), std::abs(coarse.at(n).work_J) / 5);
  }
}

/// 60 x 60 x 30 mm on a bed, pressed in its middle by a sphere of 5 mm: what a pad in a scene is like.
class HardPress : public testing::Test {
 protected:
  static constexpr double kSmall_m = 0.005;
  static constexpr double kHigh_m = 0.03;

  static scene::Point above(double depth_m) { return {0.0312, 0.0291, kHigh_m + kSmall_m - depth_m}; }

  void comes_to_rest() {
    TissueResult result;
    for (int n = 0; n < 60 && !(result.energy_J == 0 && n > 0); ++n) result = felt.step(above(-0.01));
    EXPECT_EQ(result.energy_J, 0);
    EXPECT_EQ(result.force_N, scene::Point::Zero());
    EXPECT_TRUE(felt.body.now.displacement_m.isZero(0));
  }

  CorotationalTissue tissue =
      tissue_of(test::tetrahedra_of({.cubes = {6, 6, 3}, .cube_m = 0.01}), {.radius_m = kSmall_m});
  Felt felt{tissue};
};

TEST_F(HardPress, AtOneMetreASecondAndFourRadiiDeepPushesOutAndComesBack) {
  double last_N = 0;
  TissueResult result;
  for (int n = -2; n <= 20; ++n) {
    result = felt.step(above(1e-3 * n));
    EXPECT_TRUE(result.finite);
    EXPECT_GE(result.force_N.z(), 0.98 * last_N) << n << " mm";
    last_N = result.force_N.z();
  }
  EXPECT_GT(last_N, 0.5);
  for (int n = 0; n < 50; ++n) result = felt.step(above(0.02));
  EXPECT_TRUE(result.converged);
  EXPECT_NEAR(result.force_N.z() / last_N, 1, 0.2);
  EXPECT_GT(result.normal.z(), 0.95);
  EXPECT_NEAR(result.depth_m, 0.02, 0.001);
  for (int n = 20; n >= -2; --n) {
    result = felt.step(above(1e-3 * n));
    EXPECT_GE(result.force_N.z(), -1e-3) << n << " mm";
  }
  comes_to_rest();
}

TEST_F(HardPress, ALeapFourRadiiDeepIsPushedOutAsIfItHadComeSlowly) {
  static_cast<void>(felt.step(above(-0.005)));
  TissueResult result;
  for (int n = 0; n < 60; ++n) {
    result = felt.step(above(0.02));
    EXPECT_GE(result.force_N.z(), 0) << n;
  }
  EXPECT_TRUE(result.converged);
  Felt slow(tissue);
  const TissueResult expected = slow.go(above(-0.001), above(0.02), 70);
  EXPECT_LT((result.force_N - expected.force_N).norm(), 0.005 * expected.force_N.norm());
  static_cast<void>(felt.step(above(-0.01)));
  comes_to_rest();
}

TEST_F(HardPress, AProbeThatBeginsInsideIsPushedOut) {
  TissueResult result;
  for (int n = 0; n < 60; ++n) {
    result = felt.step(above(0.012));
    EXPECT_GE(result.force_N.z(), 0) << n;
  }
  EXPECT_GT(result.force_N.z(), 0.1);
  EXPECT_TRUE(result.converged);
}

TEST_F(HardPress, AtWhatIsHeldItStopsWithoutForcesBeyondBounds) {
  // From below, against the bed.
  TissueResult result;
  double most_N = 0;
  for (int n = 0; n < 60; ++n) {
    result = felt.step({0.0312, 0.0291, -0.006 + 2e-4 * n});
    EXPECT_TRUE(result.finite);
    EXPECT_LE(result.force_N.z(), 0);
    most_N = std::max(most_N, result.force_N.norm());
  }
  EXPECT_FALSE(result.converged) << "it is not at the probe, and reports that";
  EXPECT_GT(most_N, 1);
  EXPECT_LT(most_N, 50);
  for (int n = 0; n < 3; ++n) result = felt.step({0.0312, 0.0291, -0.006});
  EXPECT_EQ(result.force_N, scene::Point::Zero());
}

TEST(CorotationalSphere, IsFeltInTheMiddleOfATriangleThatIsLargeBesideIt) {
  // The triangles are five times as wide as the sphere's radius.
  const CorotationalTissue tissue =
      tissue_of(test::tetrahedra_of({.cubes = {2, 2, 1}, .cube_m = 0.02}), {.radius_m = 0.004});
  for (const scene::Point& at : {scene::Point(0.0067, 0.0133, 0), scene::Point(0.0133, 0.0067, 0),
                                 scene::Point(0.01, 0.01, 0), scene::Point(0.02, 0.01, 0)}) {
    Felt felt(tissue);
    const TissueResult result = felt.go(over(at.x(), at.y(), -0.001, 0.004), over(at.x(), at.y(), 0.002, 0.004), 10);
    EXPECT_GT(result.force_N.z(), 0.01) << at.transpose();
    EXPECT_GT(result.contacts, 5);
    EXPECT_NEAR(result.depth_m, 0.002, 0.0002);
  }
}

TEST(CorotationalSphere, TwoPressTheSameTissueAlike) {
  const CorotationalTissue tissue = pad(patient(kProbeRadius_m));
  CorotationalTissueWorld world(tissue, 2);
  while (world.join() >= 0) continue;
  // Cells of six tetrahedra are their own mirror image in the plane x = y.
  const auto move = [&](double depth_m) {
    world.move(0, over(0.0145, 0.0255, depth_m), scene::Point::Zero());
    world.move(1, over(0.0255, 0.0145, depth_m), scene::Point::Zero());
  };
  for (int n = 0; n <= 10; ++n) move(5e-4 * n - 1e-3);
  for (int n = 0; n < 10; ++n) move(0.004);
  const TissueResult& one = world.seat(0).result;
  const TissueResult& other = world.seat(1).result;
  EXPECT_GT(one.force_N.z(), 0.05);
  const scene::Point mirrored_N(other.force_N.y(), other.force_N.x(), other.force_N.z());
  EXPECT_LT((one.force_N - mirrored_N).norm(), 1e-4 * one.force_N.norm());
  EXPECT_NEAR(one.energy_J / other.energy_J, 1, 1e-4) << "they have one energy";
  const double beside_N = one.force_N.z();
  world.leave(1);
  for (int n = 0; n < 10; ++n) world.move(0, over(0.0145, 0.0255, 0.004), scene::Point::Zero());
  EXPECT_GT(std::abs(world.seat(0).result.force_N.z() - beside_N), 0.002 * beside_N) << "its load has gone with it";
}

TEST(CorotationalSphere, WildLeapsOfTwoProbesOnAThinSheetStayBoundedAndLeaveNothingBehind) {
  // 80 x 80 x 3 mm, half as thick as the sphere's radius, held at one edge.
  TetrahedralMesh mesh(
      tetrahedral_block({.cells = {8, 8, 1}, .from_m = scene::Point::Zero(), .size_m = {0.08, 0.08, 0.003}}));
  const std::vector<int> held = nodes_below(mesh, scene::Point::Zero(), scene::Point::UnitX());
  const CorotationalTissue tissue(std::move(mesh), {.young_Pa = 20000, .poisson = 0.4}, held, {.radius_m = 0.006});
  CorotationalTissueWorld world(tissue, 2);
  while (world.join() >= 0) continue;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  std::array<scene::Point, 2> at_m{scene::Point(0.03, 0.04, 0.02), scene::Point(0.06, 0.04, 0.02)};
  double most_N = 0;
  for (int n = 0; n < 300; ++n) {
    for (const std::size_t seat : {0U, 1U}) {
      const double reach_m = any(random) > 0.9 ? 0.05 : 0.002;
      const scene::Point leap_m = reach_m * scene::Point(any(random), any(random), any(random));
      at_m[seat] =
          (at_m[seat] + leap_m).cwiseMax(scene::Point(-0.02, -0.02, -0.04)).cwiseMin(scene::Point(0.1, 0.1, 0.04));
      world.move(static_cast<int>(seat), at_m[seat], scene::Point::Zero());
      most_N = std::max(most_N, world.seat(static_cast<int>(seat)).result.force_N.norm());
    }
  }
  EXPECT_TRUE(world.sound());
  EXPECT_GT(most_N, 0.1);
  EXPECT_LT(most_N, 50);
  for (int n = 0; n < 300; ++n) {
    for (const int seat : {0, 1}) world.move(seat, {0.03, 0.04, 0.3}, scene::Point::Zero());
  }
  EXPECT_EQ(world.seat(0).result.energy_J, 0);
  EXPECT_EQ(world.seat(0).result.force_N, scene::Point::Zero());
}

TEST(CorotationalSphere, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const CorotationalTissue tissue = pad({.radius_m = kProbeRadius_m});
  CorotationalTissueWorld world(tissue, 2);
  const test::AllocationGuard guard;
  while (world.join() >= 0) continue;
  for (int n = 0; n <= 10; ++n) {
    world.move(0, over(0.011, 0.02, 5e-4 * n - 1e-3), scene::Point::Zero());
    world.move(1, over(0.029, 0.02, 5e-4 * n - 1e-3), scene::Point::Zero());
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_GT(world.seat(1).result.contacts, 0);
}

TEST(CorotationalSphere, RefusesASkinThatIsTooStiffAndAnInvalidRadius) {
  EXPECT_THROW(pad({.radius_m = -1}), std::invalid_argument);
  EXPECT_THROW(pad({.radius_m = kProbeRadius_m, .contact_stiffness_Pa_per_m = 1e9}), std::invalid_argument);
  EXPECT_THROW(pad({.radius_m = kProbeRadius_m, .contact_stiffness_Pa_per_m = -1}), std::invalid_argument);
  EXPECT_THROW(pad({.radius_m = 1e-5}), std::runtime_error);
}

}  // namespace
}  // namespace forcebound::tissue
