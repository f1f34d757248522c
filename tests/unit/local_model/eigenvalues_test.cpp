#include "forcebound/local_model/eigenvalues.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace forcebound::local_model {
namespace {

TEST(Eigenvalues, OfASymmetricMatrixAreThoseOfItsAxesTheLeastFirst) {
  const Eigen::Vector3d values(3, -1, 2);
  const Eigen::Matrix3d axes = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Eigen::Matrix3d matrix = axes * values.asDiagonal() * axes.transpose();
  EXPECT_LT((eigenvalues(matrix) - Eigen::Vector3d(-1, 2, 3)).norm(), 1e-14);
  EXPECT_EQ(eigenvalues(Eigen::Matrix3d::Zero()), Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace forcebound::local_model
