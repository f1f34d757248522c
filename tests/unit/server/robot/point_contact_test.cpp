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

/// A mass that flies at a surface, in steps as the robot's. @return how fast it comes back, by how fast it came
double rebound(const ContactMaterial& material, double mass_kg, double speed, double begin_m) {
  PointContact contact;
  double height_m = begin_m;
  double velocity = -speed;
  while (velocity < 0 || height_m < 0) {
    const Vector3d force = contact.force(
        material, {.normal = Vector3d::UnitZ(), .depth_m = -height_m, .velocity = {0, 0, velocity}}, kStep_s);
    velocity += kStep_s * force.z() / mass_kg;
    height_m += kStep_s * velocity;
  }
  return velocity / speed;
}

TEST(PointContact, ThrowsNothingBackFasterThanItCame) {
  for (const double stiffness_N_per_m : {800.0, 1e4, 2e4}) {
    for (const double speed : {0.02, 0.1, 0.5}) {
      // Wherever between two steps it touches.
      for (double begin_m = 1e-5; begin_m < kStep_s * speed + 1e-5; begin_m += 0.1 * kStep_s * speed) {
        const ContactMaterial material{.stiffness_N_per_m = stiffness_N_per_m, .damping_s_per_m = 3, .friction = 0};
        EXPECT_LE(rebound(material, 1, speed, begin_m), 1.02) << stiffness_N_per_m << " N/m, " << speed << " m/s";
        EXPECT_GT(rebound(material, 1, speed, begin_m), 0.2);
      }
    }
  }
}

}  // namespace
}  // namespace forcebound::server
