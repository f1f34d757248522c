#include "forcebound/control/rotation.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace forcebound::control {
namespace {

Eigen::Vector3d any_vector(double most) {
  const auto part = [&] { return most * 1e-6 * *rc::gen::inRange(-1'000'000, 1'000'001); };
  return {part(), part(), part()};
}

TEST(RotationVector, LeadsFromOneOrientationToTheOther) {
  rc::check([] {
    const Eigen::Quaterniond from = turn_by(any_vector(3));
    const Eigen::Vector3d turned = any_vector(1.7);
    RC_ASSERT((rotation_vector(from, turn_by(turned) * from) - turned).norm() < 1e-12);
  });
}

TEST(RotationVector, IsTheSameForBothQuaternionsOfAnOrientation) {
  const Eigen::Quaterniond from = turn_by({0.3, -0.2, 1});
  const Eigen::Quaterniond to = turn_by({0.1, 0.4, -0.2}) * from;
  const Eigen::Quaterniond other(-to.w(), -to.x(), -to.y(), -to.z());
  EXPECT_LT((rotation_vector(from, to) - rotation_vector(from, other)).norm(), 1e-15);
}

TEST(RotationVector, OfNextToNothingIsExact) {
  const Eigen::Quaterniond from = turn_by({1, 2, 0.5});
  for (const double angle : {0.0, 1e-12, 1e-9, 3e-8, 1e-7}) {
    const Eigen::Vector3d turned(0, angle, 0);
    EXPECT_LT((rotation_vector(from, turn_by(turned) * from) - turned).norm(), 1e-15);
  }
}

TEST(RotationVector, OfHalfATurnHasItsLength) {
  const Eigen::Quaterniond half = turn_by({0, 0, std::numbers::pi});
  EXPECT_NEAR(rotation_vector(Eigen::Quaterniond::Identity(), half).norm(), std::numbers::pi, 1e-12);
}

TEST(TurnBetween, LeadsFromOneDirectionToTheOtherByTheShorterWay) {
  rc::check([] {
    const Eigen::Vector3d from = any_vector(3);
    const Eigen::Vector3d to = any_vector(1.7);
    RC_PRE(from.norm() > 1e-3 && to.norm() > 1e-3);
    const Eigen::Quaterniond turn = turn_between(from, to);
    RC_ASSERT(std::abs(turn.norm() - 1) < 1e-12);
    RC_ASSERT(turn.w() >= 0);
    RC_ASSERT((turn * from.normalized() - to.normalized()).norm() < 1e-6);
  });
}

TEST(TurnBetween, OppositeDirectionsIsHalfATurn) {
  const std::vector<Eigen::Vector3d> directions{{0, 0, 2}, {3, 0, 0}, {0, -1, 0}, {1, 1, 1}, {0.2, -0.9, 0.1}};
  for (const Eigen::Vector3d& from : directions) {
    const Eigen::Quaterniond turn = turn_between(from, -0.5 * from);
    EXPECT_NEAR(turn.norm(), 1, 1e-15);
    EXPECT_LT((turn * from + from).norm(), 1e-14);
  }
}

}  // namespace
}  // namespace forcebound::control
