#include "forcebound/tissue/rotation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <random>
#include <string>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::tissue {
namespace {

Eigen::Matrix3d any_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .toRotationMatrix();
}

void expect_rotation(const Eigen::Matrix3d& found) {
  EXPECT_LT((found * found.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_NEAR(found.determinant(), 1, 1e-12);
}

TEST(NearestRotation, UndoesAnyStretch) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> stretch(0.05, 4);
  for (int n = 0; n < 2000; ++n) {
    const Eigen::Matrix3d rotation = any_rotation(random);
    const Eigen::Matrix3d axes = any_rotation(random);
    const Eigen::Vector3d stretches(stretch(random), stretch(random), stretch(random));
    const Eigen::Matrix3d found = nearest_rotation(rotation * axes * stretches.asDiagonal() * axes.transpose());
    EXPECT_LT((found - rotation).norm(), 1e-12) << "seed 1, trial " << n;
  }
}

TEST(NearestRotation, OfWhatIsTurnedInsideOutReversesTheSmallestStretch) {
  std::mt19937_64 random(2);
  for (int n = 0; n < 500; ++n) {
    const Eigen::Matrix3d rotation = any_rotation(random);
    const Eigen::Matrix3d axes = any_rotation(random);
    const Eigen::Vector3d stretches(1.5, 0.8, -0.3);
    const Eigen::Matrix3d found = nearest_rotation(rotation * axes * stretches.asDiagonal() * axes.transpose());
    EXPECT_LT((found - rotation).norm(), 1e-12) << "seed 2, trial " << n;
  }
}

TEST(NearestRotation, IsARotationForWhateverIsFlatOrTiny) {
  expect_rotation(nearest_rotation(Eigen::Matrix3d::Zero()));
  expect_rotation(nearest_rotation(1e-200 * Eigen::Matrix3d::Identity()));
  expect_rotation(nearest_rotation(-Eigen::Matrix3d::Identity()));
  expect_rotation(nearest_rotation(Eigen::Vector3d(1, 0, 0).asDiagonal()));
  expect_rotation(nearest_rotation(Eigen::Vector3d(1, 1, 1e-9).asDiagonal()));
  expect_rotation(nearest_rotation(Eigen::Vector3d(1e6, 1, 1e-6).asDiagonal()));
  expect_rotation(nearest_rotation(Eigen::Matrix3d::Constant(1)));
}

TEST(PolarParts, AreTheNearestRotationAndItsStretchFromWhereverTheSearchBegins) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> any(-1.5, 1.5);
  for (int n = 0; n < 2000; ++n) {
    SCOPED_TRACE("seed 4, trial " + std::to_string(n));
    Eigen::Matrix3d deformation;
    for (double& entry : deformation.reshaped()) entry = any(random);
    const Eigen::Matrix3d expected = nearest_rotation(deformation);
    // Far away, and as near as from one step to the next.
    const Eigen::Quaterniond beside =
        Eigen::Quaterniond(expected) * Eigen::Quaterniond(1, 1e-3 * any(random), 1e-3 * any(random), 0).normalized();
    for (const Eigen::Quaterniond& near : {Eigen::Quaterniond(any_rotation(random)), beside}) {
      const PolarParts parts = polar_parts(deformation, near);
      EXPECT_LT((parts.rotation.toRotationMatrix() * parts.stretch - deformation).norm(), 1e-6);
      // How well it is determined is a matter of the sums of two stretches.
      const Eigen::Matrix3d hold = hold_on_rotation(parts.stretch);
      const double loose =
          hold.trace() / std::max(1e-12, hold.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff());
      EXPECT_LT((parts.rotation.toRotationMatrix() - expected).norm(), 1e-8 * loose * loose);
    }
  }
}

TEST(NearestRotation, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const test::AllocationGuard guard;
  const Eigen::Matrix3d found = nearest_rotation(-Eigen::Matrix3d::Identity());
  EXPECT_EQ(guard.heap_operations(), 0U);
  expect_rotation(found);
}

}  // namespace
}  // namespace forcebound::tissue
