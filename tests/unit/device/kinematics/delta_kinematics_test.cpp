#include "forcebound/device/kinematics/delta_kinematics.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "tests/unit/device/kinematics/kinematics_checks.hpp"

namespace forcebound::device {
namespace {

using test::vector_of;

constexpr DeltaGeometry kDelta{.base_radius_m = 0.037,
                               .platform_radius_m = 0.014,
                               .upper_arm_length_m = 0.06,
                               .forearm_length_m = 0.125,
                               .side_offset_m = 0,
                               .first_arm_rad = std::numbers::pi / 2,
                               .origin_reach_m = 0.12};

TEST(DeltaKinematics, EqualAnglesLeaveTheTipOnTheAxis) {
  const double angle = 0.4;
  const Vector tip = DeltaKinematics(kDelta).position(Vector::Constant(3, angle));
  const double radius = 0.037 - 0.014 + 0.06 * std::cos(angle);
  EXPECT_NEAR(tip[0], 0, 1e-15);
  EXPECT_NEAR(tip[2], 0, 1e-15);
  EXPECT_NEAR(0.12 - tip[1], 0.06 * std::sin(angle) + std::sqrt(0.125 * 0.125 - radius * radius), 1e-15);
}

TEST(DeltaKinematics, AllArmsForwardsBringTheTipToTheUser) {
  const DeltaKinematics delta(kDelta);
  EXPECT_LT(delta.position(Vector::Constant(3, 0.5))[1], delta.position(Vector::Constant(3, 0.4))[1]);
}

TEST(DeltaKinematics, TheUpperArmForwardsLowersTheTip) {
  // The first arm is above; turned to the user it shortens the way up.
  const DeltaKinematics delta(kDelta);
  const Vector before = delta.position(vector_of({0.4, 0.4, 0.4}));
  const Vector after = delta.position(vector_of({0.45, 0.4, 0.4}));
  EXPECT_LT(after[2], before[2]);
  EXPECT_NEAR(after[0], 0, 1e-15);
}

TEST(DeltaKinematics, AnglesPassedOnToTheNextArmTurnTheTipByAThird) {
  const DeltaKinematics delta(kDelta);
  const Vector tip = delta.position(vector_of({0.3, 0.5, 0.6}));
  const Vector turned = delta.position(vector_of({0.6, 0.3, 0.5}));
  // To the user's right and upwards.
  const Eigen::Vector2d wanted = Eigen::Rotation2Dd(2 * std::numbers::pi / 3) * Eigen::Vector2d(tip[0], tip[2]);
  EXPECT_NEAR(turned[0], wanted.x(), 1e-15);
  EXPECT_NEAR(turned[2], wanted.y(), 1e-15);
  EXPECT_NEAR(turned[1], tip[1], 1e-15);
}

TEST(DeltaKinematics, JointsLeadBackToThePlaceAndTheJacobianIsTheDerivative) {
  test::expect_consistent(DeltaKinematics(kDelta), vector_of({0.03, 0.03, 0.03}));
  DeltaGeometry beside = kDelta;
  beside.side_offset_m = -0.005;
  beside.first_arm_rad = 0.3;
  test::expect_consistent(DeltaKinematics(beside), vector_of({0.03, 0.03, 0.03}));
}

TEST(DeltaKinematics, ForearmsKeepTheirLengthWhateverTheSize) {
  rc::check([] {
    const auto share = [] { return *rc::gen::inRange(0, 1001) * 1e-3; };
    DeltaGeometry geometry{.base_radius_m = 0.02 + 0.1 * share(), .platform_radius_m = 0.02, .upper_arm_length_m = 0.1};
    geometry.forearm_length_m = (geometry.base_radius_m + geometry.upper_arm_length_m) * (1 + share());
    geometry.side_offset_m = 0.01 * share();
    geometry.first_arm_rad = 6 * share();
    const Vector joint = vector_of({1.2 * share(), 1.2 * share(), 1.2 * share()});
    const Vector tip = DeltaKinematics(geometry).position(joint);
    for (int i = 0; i < 3; ++i) {
      const double angle = geometry.first_arm_rad + i * 2 * std::numbers::pi / 3;
      const double out =
          geometry.base_radius_m - geometry.platform_radius_m + geometry.upper_arm_length_m * std::cos(joint[i]);
      const double side = geometry.side_offset_m;
      const Eigen::Vector3d centre(out * std::cos(angle) - side * std::sin(angle),
                                   -geometry.upper_arm_length_m * std::sin(joint[i]),
                                   out * std::sin(angle) + side * std::cos(angle));
      RC_ASSERT(std::abs((Eigen::Vector3d(tip) - centre).norm() - geometry.forearm_length_m) < 1e-12);
    }
  });
}

TEST(DeltaKinematics, GoesTowardsAPlaceOutOfReach) {
  const DeltaKinematics delta(kDelta);
  const Vector wanted = vector_of({0.3, -0.5, 0.2});
  const Vector tip = delta.position(delta.joints_at(wanted));
  EXPECT_NEAR(tip.normalized().dot(wanted.normalized()), 1, 1e-6);
  EXPECT_GT(tip.norm(), 0.03);
}

TEST(DeltaKinematics, IsFiniteEverywhere) {
  test::expect_finite_everywhere(DeltaKinematics(kDelta), 3, 100 * 0.06);
  // The forearms are too short to meet where the arms are spread, and all knees can be in one place.
  DeltaGeometry spread = kDelta;
  spread.base_radius_m = 0.074;
  spread.forearm_length_m = 0.08;
  test::expect_finite_everywhere(DeltaKinematics(spread), 3, 100 * 0.06);
}

}  // namespace
}  // namespace forcebound::device
