#include "forcebound/device/kinematics/five_bar_kinematics.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <array>
#include <cmath>
#include <numbers>

#include "tests/unit/device/kinematics/kinematics_checks.hpp"

namespace forcebound::device {
namespace {

using test::vector_of;

constexpr FiveBarGeometry kFiveBar{
    .base_distance_m = 0.038, .proximal_length_m = 0.07, .distal_length_m = 0.09, .origin_reach_m = 0.11};

TEST(FiveBarKinematics, ProximalLinksStraightToTheSideLeaveTheTipInTheMiddle) {
  // The elbows are 0.038 + 2 * 0.07 apart, the tip in front of their middle.
  const FiveBarKinematics five_bar(kFiveBar);
  const Vector tip = five_bar.position(vector_of({std::numbers::pi, 0}));
  EXPECT_NEAR(tip[0], 0, 1e-15);
  EXPECT_NEAR(tip[1], 0.11 - std::sqrt(0.09 * 0.09 - 0.089 * 0.089), 1e-15);
}

TEST(FiveBarKinematics, BothJointsTogetherTurnTheTipAboutACommonAxis) {
  FiveBarGeometry geometry = kFiveBar;
  geometry.base_distance_m = 0;
  const FiveBarKinematics five_bar(geometry);
  const Vector tip = five_bar.position(vector_of({2.2, 0.9}));
  const Vector turned = five_bar.position(vector_of({2.5, 1.2}));
  const double reach = std::hypot(tip[0], 0.11 - tip[1]);
  EXPECT_NEAR(std::hypot(turned[0], 0.11 - turned[1]), reach, 1e-15);
  EXPECT_NEAR(std::atan2(0.11 - turned[1], turned[0]) - std::atan2(0.11 - tip[1], tip[0]), 0.3, 1e-14);
}

TEST(FiveBarKinematics, MirroredJointsMirrorTheTip) {
  const FiveBarKinematics five_bar(kFiveBar);
  const Vector tip = five_bar.position(vector_of({2.4, 1.1}));
  const Vector mirrored = five_bar.position(vector_of({std::numbers::pi - 1.1, std::numbers::pi - 2.4}));
  EXPECT_NEAR(mirrored[0], -tip[0], 1e-15);
  EXPECT_NEAR(mirrored[1], tip[1], 1e-15);
}

TEST(FiveBarKinematics, JointsLeadBackToThePlaceAndTheJacobianIsTheDerivative) {
  test::expect_consistent(FiveBarKinematics(kFiveBar), vector_of({0.04, 0.03}));
}

TEST(FiveBarKinematics, ElbowsAreOutside) {
  const FiveBarKinematics five_bar(kFiveBar);
  const Vector joint = five_bar.joints_at(Vector::Zero(2));
  EXPECT_GT(joint[0], std::numbers::pi / 2);
  EXPECT_LT(joint[1], std::numbers::pi / 2);
}

TEST(FiveBarKinematics, LinksKeepTheirLengthWhateverTheSize) {
  rc::check([] {
    const auto share = [] { return *rc::gen::inRange(0, 1001) * 1e-3; };
    const double proximal = 0.03 + 0.2 * share();
    const double distal = proximal * (0.7 + share());
    const FiveBarGeometry geometry{.base_distance_m = 0.5 * distal * share(),
                                   .proximal_length_m = proximal,
                                   .distal_length_m = distal,
                                   .origin_reach_m = 0};
    const Vector joint = vector_of({1.7 + 1.2 * share(), 0.2 + 1.2 * share()});
    const Vector tip = FiveBarKinematics(geometry).position(joint);
    double apart = 0;
    std::array<double, 2> lengths{};
    std::array<Eigen::Vector2d, 2> elbows;
    for (int side = 0; side < 2; ++side) {
      const auto i = static_cast<std::size_t>(side);
      elbows[i] = {(side - 0.5) * geometry.base_distance_m + proximal * std::cos(joint[side]),
                   -proximal * std::sin(joint[side])};
      lengths[i] = (Eigen::Vector2d(tip[0], tip[1]) - elbows[i]).norm();
    }
    apart = (elbows[1] - elbows[0]).norm();
    // Beyond that nothing can be assembled.
    RC_PRE(apart < 1.99 * distal);
    RC_ASSERT(std::abs(lengths[0] - distal) < 1e-12);
    RC_ASSERT(std::abs(lengths[1] - distal) < 1e-12);
  });
}

TEST(FiveBarKinematics, GoesTowardsAPlaceOutOfReach) {
  const FiveBarKinematics five_bar(kFiveBar);
  const Vector wanted = vector_of({0.5, -0.3});
  const Vector tip = five_bar.position(five_bar.joints_at(wanted));
  EXPECT_NEAR(tip.normalized().dot(wanted.normalized()), 1, 1e-6);
  EXPECT_GT(tip.norm(), 0.02);
}

TEST(FiveBarKinematics, IsFiniteEverywhere) {
  test::expect_finite_everywhere(FiveBarKinematics(kFiveBar), 2, 100 * 0.07);
  // The elbows meet wherever the joints are the same, and there is no place where both proximal links could part.
  test::expect_finite_everywhere(
      FiveBarKinematics(
          {.base_distance_m = 0, .proximal_length_m = 0.07, .distal_length_m = 0.05, .origin_reach_m = 0.1}),
      2, 100 * 0.07);
}

}  // namespace
}  // namespace forcebound::device
