#include "forcebound/tissue/sphere_pressure.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <stdexcept>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::tissue {
namespace {

constexpr double kRadius_m = 0.008;
constexpr double kStiffness_Pa_per_m = 2e7;

/// A square of 40 mm in the plane z = 0, of two triangles, which face up.
TissueSurface square() {
  return {{{-0.02, -0.02, 0}, {0.02, -0.02, 0}, {0.02, 0.02, 0}, {-0.02, 0.02, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

SpherePressure pressure_on(const TissueSurface& surface) { return {surface, kRadius_m, kStiffness_Pa_per_m, "square"}; }

/// Corners moved by a few millimetres, the same ones every time.
Eigen::VectorXd crumpled() {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> any_m(-0.003, 0.003);
  Eigen::VectorXd displacement_m(12);
  for (double& coordinate_m : displacement_m) coordinate_m = any_m(random);
  return displacement_m;
}

const scene::Point kPressing_m(0.001, 0.0005, kRadius_m - 0.002);

TEST(SpherePressure, ForcesAreHowSteeplyTheEnergyFalls) {
  const TissueSurface surface = square();
  const SpherePressure pressure = pressure_on(surface);
  Eigen::VectorXd displacement_m = crumpled();
  constexpr double kStep_m = 1e-7;
  const auto energy_J = [&](const scene::Point& center_m) {
    return pressure.energy_J(DeformedSurface(surface, displacement_m), center_m);
  };
  const scene::Point force_N = pressure.touch(DeformedSurface(surface, displacement_m), kPressing_m).force_N;
  ASSERT_GT(force_N.norm(), 0.1);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const scene::Point step_m = kStep_m * scene::Point::Unit(axis);
    const double fall_N = (energy_J(kPressing_m - step_m) - energy_J(kPressing_m + step_m)) / (2 * kStep_m);
    EXPECT_NEAR(fall_N, force_N[axis], 1e-4 * force_N.norm()) << "on the sphere, along " << axis;
  }
  Eigen::VectorXd on_nodes_N = Eigen::VectorXd::Zero(12);
  pressure.add_forces(DeformedSurface(surface, displacement_m), kPressing_m, on_nodes_N);
  for (Eigen::Index row = 0; row < 12; ++row) {
    const double here_m = displacement_m[row];
    displacement_m[row] = here_m - kStep_m;
    const double below_J = energy_J(kPressing_m);
    displacement_m[row] = here_m + kStep_m;
    EXPECT_NEAR((below_J - energy_J(kPressing_m)) / (2 * kStep_m), on_nodes_N[row], 1e-4 * force_N.norm()) << row;
    displacement_m[row] = here_m;
  }
}

TEST(SpherePressure, ResistanceIsHowForcesChange) {
  const TissueSurface surface = square();
  const SpherePressure pressure = pressure_on(surface);
  const Eigen::VectorXd displacement_m = crumpled();
  Eigen::VectorXd along_m(12);
  for (Eigen::Index row = 0; row < 12; ++row) along_m[row] = std::sin(1.0 + static_cast<double>(row * row));
  PressedTriangles pressed(2);
  const DeformedSurface deformed(surface, displacement_m);
  pressure.add_resistance(deformed, kPressing_m, pressed);
  ASSERT_EQ(pressed.count, 2U);
  Eigen::VectorXd resisted_N = Eigen::VectorXd::Zero(12);
  for (const int triangle : pressed.touched) {
    const Eigen::Matrix3d moved_m = deformed.corners_of(triangle, along_m);
    Eigen::Matrix3d on_corners_N;
    on_corners_N.reshaped() = pressed.resistance[static_cast<std::size_t>(triangle)] * moved_m.reshaped();
    deformed.add_to_corners(triangle, on_corners_N, resisted_N);
  }
  // Small enough that no place comes or goes.
  constexpr double kStep = 1e-9;
  Eigen::VectorXd before_N = Eigen::VectorXd::Zero(12);
  Eigen::VectorXd after_N = Eigen::VectorXd::Zero(12);
  const Eigen::VectorXd before_m = displacement_m - kStep * along_m;
  const Eigen::VectorXd after_m = displacement_m + kStep * along_m;
  pressure.add_forces(DeformedSurface(surface, before_m), kPressing_m, before_N);
  pressure.add_forces(DeformedSurface(surface, after_m), kPressing_m, after_N);
  const Eigen::VectorXd change_N = (before_N - after_N) / (2 * kStep);
  EXPECT_LT((change_N - resisted_N).norm(), 1e-4 * resisted_N.norm());
  pressed.clear();
  EXPECT_EQ(pressed.count, 0U);
  for (const auto& resistance : pressed.resistance) EXPECT_TRUE(resistance.isZero(0));
}

TEST(SpherePressure, ActsAndIsReactedToWithoutForceOrTorqueOfItsOwn) {
  const TissueSurface surface = square();
  const SpherePressure pressure = pressure_on(surface);
  const Eigen::VectorXd displacement_m = crumpled();
  const DeformedSurface deformed(surface, displacement_m);
  Eigen::VectorXd on_nodes_N = Eigen::VectorXd::Zero(12);
  pressure.add_forces(deformed, kPressing_m, on_nodes_N);
  scene::Point force_N = pressure.touch(deformed, kPressing_m).force_N;
  const double size_N = force_N.norm();
  scene::Point torque_N_m = scene::Point::Zero();
  for (Eigen::Index node = 0; node < 4; ++node) {
    const scene::Point at_m = surface.nodes_m()[static_cast<std::size_t>(node)] + displacement_m.segment<3>(3 * node);
    force_N += on_nodes_N.segment<3>(3 * node);
    torque_N_m += (at_m - kPressing_m).cross(on_nodes_N.segment<3>(3 * node));
  }
  EXPECT_LT(force_N.norm(), 1e-12 * size_N);
  EXPECT_LT(torque_N_m.norm(), 1e-12 * size_N);
}

// Of a sphere by d in a plane that does not give way: pi k R d^2, to first order in d / R.
TEST(SpherePressure, IsThatOfASkinOnAPlaneWhereverOnATriangleItPresses) {
  const TissueSurface surface = square();
  const SpherePressure pressure = pressure_on(surface);
  const Eigen::VectorXd undeformed = Eigen::VectorXd::Zero(12);
  constexpr double kDepth_m = 0.0005;
  const double expected_N = 3.14159265358979 * kStiffness_Pa_per_m * kRadius_m * kDepth_m * kDepth_m;
  for (const scene::Point& over : {scene::Point(0, 0, 0), scene::Point(0.007, -0.007, 0),
                                   scene::Point(0.0031, 0.0057, 0), scene::Point(-0.01, 0.004, 0)}) {
    const scene::Point center_m = over + scene::Point(0, 0, kRadius_m - kDepth_m);
    const DeformedSurface deformed(surface, undeformed);
    const SpherePressure::Touch touch = pressure.touch(deformed, center_m);
    EXPECT_NEAR(touch.force_N.z() / expected_N, 1, 0.1) << over.transpose();
    EXPECT_LT(touch.force_N.head<2>().norm(), 0.03 * expected_N) << over.transpose();
    EXPECT_GT(touch.places, 5);
    EXPECT_NEAR(pressure.depth_at_rest_m(deformed, center_m, scene::Point::UnitZ()), kDepth_m, 0.1 * kDepth_m);
  }
}

TEST(SpherePressure, TakesMoreEnergyThanThereIsToCarryThroughTheSurface) {
  const TissueSurface surface = square();
  const SpherePressure pressure = pressure_on(surface);
  const Eigen::VectorXd undeformed = Eigen::VectorXd::Zero(12);
  const DeformedSurface deformed(surface, undeformed);
  EXPECT_EQ(pressure.energy_J(deformed, {0, 0, 1.001 * kRadius_m}), 0);
  double last_J = 0;
  for (const double away : {0.9, 0.8, 0.7, 0.6, 0.55}) {
    const double energy_J = pressure.energy_J(deformed, {0, 0, away * kRadius_m});
    EXPECT_GT(energy_J, 1.5 * last_J);
    last_J = energy_J;
  }
  EXPECT_TRUE(std::isinf(pressure.energy_J(deformed, {0, 0, 0.3 * kRadius_m})));
  EXPECT_TRUE(pressure.touch(deformed, scene::Point::Zero()).force_N.allFinite());
}

TEST(SpherePressure, GoesOnlyHalfwayIntoItsSkinAtATimeAndOutAsItLikes) {
  const TissueSurface surface = square();
  const SpherePressure pressure = pressure_on(surface);
  const Eigen::VectorXd undeformed = Eigen::VectorXd::Zero(12);
  const DeformedSurface deformed(surface, undeformed);
  const scene::Point above_m(0.002, 0.001, 0.05);
  const scene::Point below_m(0.002, 0.001, -0.05);
  scene::Point center_m = above_m;
  double last_m = 0;
  for (int n = 0; n < 40; ++n) {
    center_m += pressure.free_share(deformed, center_m, below_m) * (below_m - center_m);
    const double depth_m = pressure.touch(deformed, center_m).deepest_m;
    EXPECT_LE(depth_m, std::min(0.5 * (last_m + pressure.skin_m()), 0.75 * pressure.skin_m()) + 1e-9);
    last_m = depth_m;
  }
  EXPECT_NEAR(last_m, 0.75 * pressure.skin_m(), 1e-6) << "where nothing gives way it comes to a stop";
  EXPECT_EQ(pressure.free_share(deformed, center_m, above_m), 1);
  EXPECT_EQ(pressure.free_share(deformed, above_m, above_m + scene::Point(1, 2, 3)), 1);
}

TEST(SpherePressure, RefusesASphereTooSmallBesideTheSurfaceAndSaysWhatWouldDo) {
  const TissueSurface surface = square();
  try {
    const SpherePressure pressure(surface, 0.001, 1e7, "square");
    FAIL() << pressure.places();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::MatchesRegex("square: a sphere of radius 0.001 m is too small beside edges of "
                                                    "0.0566 m on a surface of 2 triangles: expected 0 .a point., or "
                                                    "at least 0.00355 m"));
  }
  EXPECT_NO_THROW(SpherePressure(surface, 0.00355, 1e7, "square"));
}

TEST(SpherePressure, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const TissueSurface surface = square();
  const SpherePressure pressure = pressure_on(surface);
  const Eigen::VectorXd undeformed = Eigen::VectorXd::Zero(12);
  Eigen::VectorXd on_nodes_N = undeformed;
  PressedTriangles pressed(2);
  const test::AllocationGuard guard;
  const DeformedSurface deformed(surface, undeformed);
  pressure.add_forces(deformed, kPressing_m, on_nodes_N);
  pressure.add_resistance(deformed, kPressing_m, pressed);
  pressed.clear();
  EXPECT_GT(pressure.energy_J(deformed, kPressing_m), 0);
  EXPECT_GT(pressure.free_share(deformed, kPressing_m, scene::Point::Zero()), 0);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::tissue
