#include "forcebound/device/kinematics/arm_kinematics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace forcebound::device {
namespace {

constexpr ArmGeometry kArm{
    .upper_length_m = 0.1335, .fore_length_m = 0.12, .origin_reach_m = 0.16, .origin_height_m = 0.02};

Vector joints(double yaw, double shoulder, double elbow) {
  Vector result(3);
  result << yaw, shoulder, elbow;
  return result;
}

TEST(ArmKinematics, LevelUpperLinkAndHangingForeLinkReachWhereTheyShould) {
  const Vector tip = ArmKinematics(kArm).position(joints(0, 0, 0));
  EXPECT_NEAR(tip[0], 0, 1e-16);
  EXPECT_NEAR(tip[1], 0.16 - 0.1335, 1e-16);
  EXPECT_NEAR(tip[2], -0.12 - 0.02, 1e-16);
}

TEST(ArmKinematics, LiftingTheUpperLinkRaisesZ) {
  const ArmKinematics arm(kArm);
  EXPECT_GT(arm.position(joints(0, 0.1, 0))[2], arm.position(joints(0, 0, 0))[2]);
}

TEST(ArmKinematics, YawToTheRightMovesTheTipToPositiveX) {
  EXPECT_GT(ArmKinematics(kArm).position(joints(0.3, 0.5, 0.5))[0], 0.01);
}

TEST(ArmKinematics, JacobianIsTheDerivative) {
  const ArmKinematics arm(kArm);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(-3, 3);
  constexpr double kStep = 1e-6;
  for (int trial = 0; trial < 200; ++trial) {
    const Vector q = joints(angle(random), angle(random), angle(random));
    const Matrix jacobian = arm.jacobian(q);
    for (int i = 0; i < 3; ++i) {
      Vector above = q;
      Vector below = q;
      above[i] += kStep;
      below[i] -= kStep;
      const Vector numeric = (arm.position(above) - arm.position(below)) / (2 * kStep);
      ASSERT_LT((numeric - jacobian.col(i)).norm(), 1e-10) << q.transpose() << ", joint " << i;
    }
  }
}

TEST(ArmKinematics, JointsAtComesBackToThePosition) {
  const ArmKinematics arm(kArm);
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> offset(-0.05, 0.05);
  for (int trial = 0; trial < 200; ++trial) {
    const Vector wanted = joints(offset(random), offset(random), offset(random));
    ASSERT_LT((arm.position(arm.joints_at(wanted)) - wanted).norm(), 1e-15) << wanted.transpose();
  }
}

TEST(ArmKinematics, ArmPointsAtAPositionBeyondItsReach) {
  const ArmKinematics arm(kArm);
  const Vector shoulder = joints(0, 0.16, -0.02);
  const Vector wanted = joints(0.5, 0.7, 0.2);
  const Vector tip = arm.position(arm.joints_at(wanted));
  EXPECT_NEAR((tip - shoulder).norm(), 0.1335 + 0.12, 1e-12);
  EXPECT_NEAR((tip - shoulder).normalized().dot((wanted - shoulder).normalized()), 1, 1e-12);
}

TEST(ArmKinematics, AtTheShoulderItselfEverythingIsFinite) {
  const ArmKinematics arm(kArm);
  EXPECT_TRUE(arm.joints_at(joints(0, 0.16, -0.02)).allFinite());
}

}  // namespace
}  // namespace forcebound::device
