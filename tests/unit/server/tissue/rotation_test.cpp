#include "forcebound/server/tissue/rotation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <random>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::server {
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

TEST(NearestRotation, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const test::AllocationGuard guard;
  const Eigen::Matrix3d found = nearest_rotation(-Eigen::Matrix3d::Identity());
  EXPECT_EQ(guard.heap_operations(), 0U);
  expect_rotation(found);
}

}  // namespace
}  // namespace forcebound::server
