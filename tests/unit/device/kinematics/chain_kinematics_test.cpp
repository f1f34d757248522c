#include "forcebound/device/kinematics/chain_kinematics.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <stdexcept>

#include "forcebound/control/rotation.hpp"
#include "forcebound/device/kinematics/arm_kinematics.hpp"
#include "tests/unit/device/kinematics/kinematics_checks.hpp"

namespace forcebound::device {
namespace {

using test::vector_of;

/// Links of 0.1 m one after another, to the user's right at zero angles, each on a joint that turns in the level plane.
ChainGeometry planar(int links, double start_rad) {
  ChainGeometry geometry;
  geometry.tip_axes = 2;
  for (int i = 0; i < links; ++i) {
    geometry.joints.push_back({.axis = {0, 0, 1}, .point_m = {0.1 * i - 0.15, 0, 0}, .start_rad = start_rad});
  }
  geometry.tip_m = {0.1 * links - 0.15, 0, 0};
  return geometry;
}

/// Yaw, shoulder and elbow of an arm 0.16 m in front of the origin, a wrist behind them, and more turns of it.
ChainGeometry arm(int joints) {
  ChainGeometry geometry;
  geometry.joints = {{.axis = {0, 0, 1}, .point_m = {0, 0.16, 0}, .start_rad = 0.1},
                     {.axis = {-2, 0, 0}, .point_m = {0, 0.16, 0}, .start_rad = -0.8},
                     {.axis = {1, 0, 0}, .point_m = {0, 0.03, 0}, .start_rad = 1.6},
                     {.axis = {1, 0, 0}, .point_m = {0, -0.1, 0}, .start_rad = 0.4},
                     {.axis = {0, 1, 0}, .point_m = {0, -0.1, 0.01}, .start_rad = 0.2},
                     {.axis = {0, 0, 1}, .point_m = {0, -0.12, 0}, .start_rad = 0.1}};
  geometry.joints.resize(static_cast<std::size_t>(joints));
  geometry.tip_m = {0, -0.15, 0};
  return geometry;
}

TEST(ChainKinematics, PlanarLinksAddUp) {
  const Vector tip = ChainKinematics(planar(3, 0)).position(vector_of({0.3, 0.4, -0.2}));
  EXPECT_NEAR(tip[0], -0.15 + 0.1 * (std::cos(0.3) + std::cos(0.7) + std::cos(0.5)), 1e-15);
  EXPECT_NEAR(tip[1], 0.1 * (std::sin(0.3) + std::sin(0.7) + std::sin(0.5)), 1e-15);
}

TEST(ChainKinematics, IsTheArmWhereItsJointsAreThose) {
  const ArmGeometry size{
      .upper_length_m = 0.13, .fore_length_m = 0.12, .origin_reach_m = 0.16, .origin_height_m = 0.02};
  // The arm's elbow angle is to the vertical, that of a joint on the upper link is to that.
  ChainGeometry geometry;
  geometry.joints = {{.axis = {0, 0, 1}, .point_m = {0, 0.16, 0}},
                     {.axis = {-1, 0, 0}, .point_m = {0, 0.16, -0.02}},
                     {.axis = {-1, 0, 0}, .point_m = {0, 0.16 - 0.13, -0.02}}};
  geometry.tip_m = {0, 0.16 - 0.13, -0.02 - 0.12};
  const ChainKinematics chain(geometry);
  const ArmKinematics arm(size);
  rc::check([&] {
    const auto angle = [] { return *rc::gen::inRange(-3000, 3001) * 1e-3; };
    const Vector q = vector_of({angle(), angle(), angle()});
    RC_ASSERT((chain.position(vector_of({q[0], q[1], q[2] - q[1]})) - arm.position(q)).norm() < 1e-14);
  });
}

TEST(ChainKinematics, JointsLeadBackToThePlaceAndTheJacobianIsTheDerivative) {
  test::expect_consistent(ChainKinematics(arm(3)), vector_of({0.05, 0.05, 0.05}), 100);
  test::expect_consistent(ChainKinematics(planar(2, 1.2)), vector_of({0.02, 0.02}), 100);
}

/// The arm with all of its six joints for six axes; its gimbal's axes meet at the tip.
ChainGeometry turning_arm() {
  ChainGeometry geometry = arm(6);
  geometry.tip_axes = 6;
  for (std::size_t i = 3; i < 6; ++i) geometry.joints[i].point_m = geometry.tip_m;
  geometry.joints[3].axis = {0, 0, 1};
  geometry.joints[4].axis = {1, 0, 0};
  geometry.joints[5].axis = {0, 1, 0};
  return geometry;
}

TEST(ChainKinematics, OfSixAxesHasTheAngularVelocityInTheLastRowsOfItsJacobian) {
  const ChainKinematics chain(turning_arm());
  rc::check([&] {
    const auto angle = [] { return *rc::gen::inRange(-3000, 3001) * 1e-3; };
    const Vector q = vector_of({angle(), angle(), angle(), angle(), angle(), angle()});
    const Matrix jacobian = chain.jacobian(q);
    RC_ASSERT(jacobian.rows() == 6 && jacobian.cols() == 6);
    constexpr double kStep_rad = 1e-6;
    for (Eigen::Index i = 0; i < 6; ++i) {
      Vector above = q;
      Vector below = q;
      above[i] += kStep_rad;
      below[i] -= kStep_rad;
      const Eigen::Vector3d moved = (chain.position(above) - chain.position(below)) / (2 * kStep_rad);
      const Eigen::Vector3d turned =
          control::rotation_vector(*chain.orientation(below), *chain.orientation(above)) / (2 * kStep_rad);
      RC_ASSERT((jacobian.col(i).head<3>() - moved).norm() < 1e-8);
      RC_ASSERT((jacobian.col(i).tail<3>() - turned).norm() < 1e-8);
    }
  });
}

TEST(ChainKinematics, OfSixAxesComesToAPlaceTurnedAsAsked) {
  const ChainKinematics chain(turning_arm());
  rc::check([&] {
    const auto part = [](double most) { return most * 1e-3 * *rc::gen::inRange(-1000, 1001); };
    const Vector place = vector_of({part(0.04), part(0.04), part(0.04)});
    const Eigen::Quaterniond turned = control::turn_by({part(0.5), part(0.5), part(0.5)});
    const Vector q = chain.joints_at_pose(place, turned);
    RC_ASSERT((chain.position(q) - place).norm() < 1e-9);
    RC_ASSERT(control::rotation_vector(*chain.orientation(q), turned).norm() < 1e-9);
  });
}

TEST(ChainKinematics, OfFourOrFiveAxesIsRefused) {
  for (const int axes : {4, 5}) {
    ChainGeometry geometry = arm(6);
    geometry.tip_axes = axes;
    EXPECT_THROW(ChainKinematics{geometry}, std::invalid_argument);
  }
}

TEST(ChainKinematics, MoreJointsThanAxesLeadBackToThePlaceToo) {
  for (const int joints : {4, 5, 6}) {
    SCOPED_TRACE(joints);
    const ChainKinematics chain(arm(joints));
    EXPECT_EQ(chain.jacobian(Vector::Zero(joints)).cols(), joints);
    EXPECT_EQ(chain.jacobian(Vector::Zero(joints)).rows(), 3);
    test::expect_consistent(chain, vector_of({0.05, 0.05, 0.05}), 100);
  }
  test::expect_consistent(ChainKinematics(planar(5, 0.9)), vector_of({0.1, 0.1}), 100);
}

TEST(ChainKinematics, GoesTowardsAPlaceOutOfReach) {
  const ChainKinematics chain(planar(3, 0.3));
  const Vector tip = chain.position(chain.joints_at(vector_of({3, 4})));
  // All but stretched, from its base at x = -0.15.
  const Vector way = tip - vector_of({-0.15, 0});
  EXPECT_NEAR(way.norm(), 0.3, 1e-3);
  EXPECT_NEAR(std::atan2(way[1], way[0]), std::atan2(4, 3.15), 0.02);
}

TEST(ChainKinematics, IsFiniteEverywhere) {
  for (const int joints : {3, 6}) test::expect_finite_everywhere(ChainKinematics(arm(joints)), joints, 0.4);
  test::expect_finite_everywhere(ChainKinematics(planar(6, 0)), 6, 0.7);
}

TEST(ChainKinematics, RefusesWhatIsNoChain) {
  EXPECT_THROW(ChainKinematics{ChainGeometry{}}, std::invalid_argument);
  EXPECT_THROW(ChainKinematics{arm(2)}, std::invalid_argument) << "three axes of the tip";
  EXPECT_THROW(ChainKinematics{planar(7, 0)}, std::invalid_argument);
  ChainGeometry pointless = arm(3);
  pointless.joints[1].axis.setZero();
  EXPECT_THROW(ChainKinematics{pointless}, std::invalid_argument);
}

}  // namespace
}  // namespace forcebound::device
