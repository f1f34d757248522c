#include "forcebound/server/robot/point_contact.hpp"

#include <gtest/gtest.h>

namespace forcebound::server {
namespace {

using Eigen::Vector3d;

constexpr double kStep_s = 5e-4;
constexpr ContactMaterial kSteel{.stiffness_N_per_m = 1e4, .damping_s_per_m = 2, .friction = 0.3};

TEST(PointContact, ShowsTheStiffnessItIsGiven) {
  for (const double depth_m : {1e-5, 1e-4, 1e-3}) {
    PointContact contact;
    const Vector3d force =
        contact.force(kSteel, {.normal = Vector3d::UnitZ(), .depth_m = depth_m, .velocity = Vector3d::Zero()}, kStep_s);
    EXPECT_NEAR(force.z(), 1e4 * depth_m, 1e-12);
    EXPECT_EQ(force.head<2>().norm(), 0);
  }
}

TEST(PointContact, PushesHarderWhileItIsApproachedAndNeverPulls) {
  const auto pressed = [](double speed) {
    PointContact contact;
    return contact.force(kSteel, {.normal = Vector3d::UnitZ(), .depth_m = 1e-3, .velocity = {0, 0, speed}}, kStep_s)
        .z();
  };
  EXPECT_NEAR(pressed(-0.1), 12, 1e-12);
  EXPECT_NEAR(pressed(0.1), 8, 1e-12);
  EXPECT_EQ(pressed(1), 0);
}

TEST(PointContact, TouchesNothingAboveTheSurface) {
  PointContact contact;
  EXPECT_TRUE(contact.force(kSteel, {.normal = Vector3d::UnitZ(), .depth_m = -1e-9, .velocity = {1, 0, -1}}, kStep_s)
                  .isZero(0));
}

TEST(PointContact, SticksUntilFrictionIsOvercomeAndThenSlides) {
  PointContact contact;
  const auto moved = [&](double speed) {
    return contact.force(kSteel, {.normal = Vector3d::UnitZ(), .depth_m = 1e-3, .velocity = {speed, 0, 0}}, kStep_s)
        .x();
  };
  // 10 N times 0.3 is 3 N; a bristle of 8 N/mm bends 0.375 mm for that.
  for (int i = 0; i < 100; ++i) (void)moved(1e-3);
  EXPECT_NEAR(moved(0), -0.4, 1e-9) << "after 0.05 mm";
  for (int i = 0; i < 1000; ++i) EXPECT_GE(moved(0.1), -3 - 1e-12);
  EXPECT_NEAR(moved(0.1), -3, 1e-12);
  EXPECT_NEAR(moved(0), -3, 1e-9) << "it holds where it stopped";
  EXPECT_GT(moved(-0.1), -2.9) << "and gives way the other way";
}

}  // namespace
}  // namespace forcebound::server
