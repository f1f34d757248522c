#include "forcebound/client/rendering/surface_contact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "forcebound/client/rendering/linear_field.hpp"
#include "tests/support/sample_local_model.hpp"

namespace forcebound::client {
namespace {

/// A pad that neither moves nor relaxes, with its surface at z = 0.
local_model::Surface still() {
  local_model::Surface surface = test::pad();
  surface.place_m.setZero();
  surface.damping_N_s_per_m = 0;
  surface.velocity_m_per_s.setZero();
  surface.acceleration_m_per_s2.setZero();
  surface.relaxing_N_per_m = 0;
  surface.relaxed_N = 0;
  surface.friction = 0;
  return surface;
}

DevicePoint at(double z_m, double z_m_per_s = 0) {
  return {.place_m = {0, 0, z_m}, .velocity_m_per_s = {0, 0, z_m_per_s}};
}

SurfaceContact contact_of(const local_model::Surface& surface, const DevicePoint& device = at(1),
                          const ModelAge& age = {}) {
  SurfaceContact contact;
  contact.update(surface, device, age);
  return contact;
}

TEST(SurfaceContact, PushesInProportionToTheDepthAndNotAboveTheSurface) {
  const SurfaceContact contact = contact_of(still());
  EXPECT_EQ(contact.force_N(at(0.001), {}), Point::Zero());
  EXPECT_EQ(contact.force_N(at(0), {}), Point::Zero());
  EXPECT_TRUE(contact.force_N(at(-0.002), {}).isApprox(Point(0, 0, 2)));
}

TEST(SurfaceContact, NeverPullsHoweverFastTheDeviceLeaves) {
  local_model::Surface damped = still();
  damped.damping_N_s_per_m = 10;
  const SurfaceContact contact = contact_of(damped);
  EXPECT_TRUE(contact.force_N(at(-0.002, -0.1), {}).isApprox(Point(0, 0, 3)));
  EXPECT_EQ(contact.force_N(at(-0.002, 0.3), {}), Point::Zero());
}

TEST(SurfaceContact, GoesOnByVelocityAndAcceleration) {
  local_model::Surface rising = still();
  rising.velocity_m_per_s = {0, 0, 0.05};
  rising.acceleration_m_per_s2 = {0, 0, 2};
  const SurfaceContact contact = contact_of(rising);
  const double gone_m = 0.05 * 0.04 + 0.5 * 2 * 0.04 * 0.04;
  EXPECT_NEAR(contact.force_N(at(0), {.s = 0.04}).z(), 1000 * gone_m, 1e-9);
}

TEST(SurfaceContact, GoesOnLessByAnAccelerationTheLessCertainTheAgeIs) {
  local_model::Surface rising = still();
  rising.acceleration_m_per_s2 = {0, 0, 2};
  const SurfaceContact contact = contact_of(rising);
  const double certain_N = contact.force_N(at(0), {.s = 0.04}).z();
  EXPECT_NEAR(contact.force_N(at(0), {.s = 0.04, .uncertain_s = 0.01}).z(), 0.75 * certain_N, 1e-9);
  EXPECT_EQ(contact.force_N(at(0), {.s = 0.04, .uncertain_s = 0.04}).z(), 0);
  EXPECT_EQ(contact.force_N(at(0), {.s = 0, .uncertain_s = 0.04}).z(), 0);
}

/// A device that slides 2 mm deep in a surface with friction of 1 N.
class Sliding {
 public:
  void to(double x_m, const ModelAge& age = {}) {
    constexpr double kTick_s = 1e-3;
    device.velocity_m_per_s = Point(x_m - device.place_m.x(), 0, 0) / kTick_s;
    device.place_m.x() = x_m;
    contact.advance(device, age, kTick_s);
  }
  [[nodiscard]] double dragged_N() const { return contact.force_N(device, {}).x(); }

  local_model::Surface surface = [] {
    local_model::Surface rough = still();
    rough.friction = 0.5;
    return rough;
  }();
  DevicePoint device = at(-0.002);
  SurfaceContact contact = contact_of(surface, device);
};

TEST(SurfaceContact, SticksBySpringAndSlipsAboveItsFriction) {
  Sliding hand;
  hand.to(0);
  EXPECT_EQ(hand.dragged_N(), 0);
  hand.to(0.0004);
  EXPECT_NEAR(hand.dragged_N(), -0.4, 1e-9);
  hand.to(0.010);
  EXPECT_NEAR(hand.dragged_N(), -1, 1e-9) << "mu times 2 N";
  EXPECT_NEAR(hand.contact.force_N(hand.device, {}).z(), 2, 1e-9);
  hand.to(0.0095);
  EXPECT_NEAR(hand.dragged_N(), -0.5, 1e-9) << "it sticks where it stopped";
  hand.to(0.004);
  EXPECT_NEAR(hand.dragged_N(), 1, 1e-9);
  hand.device.place_m.z() = 0.001;
  hand.to(0.003);
  EXPECT_EQ(hand.contact.force_N(hand.device, {}), Point::Zero());
  hand.device.place_m.z() = -0.002;
  hand.to(0.003);
  EXPECT_EQ(hand.dragged_N(), 0) << "touched anew";
}

TEST(SurfaceContact, GoesOnStickingWhenAnotherAnswerTellsOfTheSameSurface) {
  Sliding hand;
  hand.to(0);
  hand.to(0.0004);
  hand.surface.place_m.x() += 0.03;  // below the tool, which moved
  hand.contact.update(hand.surface, hand.device, {});
  EXPECT_NEAR(hand.dragged_N(), -0.4, 1e-9);
  hand.to(0.0006);
  EXPECT_NEAR(hand.dragged_N(), -0.6, 1e-9);
  hand.surface.id += 1;
  hand.contact.update(hand.surface, hand.device, {});
  EXPECT_EQ(hand.dragged_N(), 0) << "another surface";
}

TEST(SurfaceContact, ASurfaceThatMovesTakesTheDeviceAlong) {
  Sliding hand;
  hand.surface.velocity_m_per_s = {0.1, 0, 0};
  hand.contact.update(hand.surface, hand.device, {});
  for (int i = 0; i < 5; ++i) hand.to(0);
  EXPECT_NEAR(hand.dragged_N(), 0.5, 1e-9) << "five of its steps";
  for (int i = 0; i < 50; ++i) hand.to(0);
  EXPECT_NEAR(hand.dragged_N(), 1, 1e-9);
}

TEST(SurfaceContact, RelaxesAsASpringInSeriesWithADamper) {
  local_model::Surface relaxing = still();
  relaxing.relaxing_N_per_m = 500;
  relaxing.relaxation_s = 0.1;
  SurfaceContact contact = contact_of(relaxing);
  contact.advance(at(-0.002), {}, 1e-6);
  EXPECT_NEAR(contact.force_N(at(-0.002), {}).z(), 2 + 500 * 0.002, 1e-4) << "pressed at once";
  for (int i = 0; i < 100; ++i) contact.advance(at(-0.002), {}, 1e-3);
  EXPECT_NEAR(contact.force_N(at(-0.002), {}).z(), 2 + 500 * 0.002 * std::exp(-1), 1e-4);
  contact.advance(at(0.001), {}, 1e-3);
  contact.advance(at(-1e-9), {}, 1e-3);
  EXPECT_NEAR(contact.force_N(at(-1e-9), {}).z(), 0, 1e-5) << "it has let go";
}

TEST(SurfaceContact, KeepsWhatRelaxesThroughAnswersAboutTheSameSurface) {
  local_model::Surface relaxing = still();
  relaxing.relaxing_N_per_m = 500;
  relaxing.relaxation_s = 0.1;
  SurfaceContact contact = contact_of(relaxing);
  contact.advance(at(-0.002), {}, 1e-6);
  const double before_N = contact.force_N(at(-0.002), {}).z();
  relaxing.place_m = {0, 0, 0.001};
  relaxing.relaxed_N = 7;
  contact.update(relaxing, at(-0.002), {});
  EXPECT_NEAR(contact.force_N(at(-0.002), {}).z(), before_N + 1, 1e-6) << "elastic, by a millimetre";
  relaxing.id += 1;
  contact.update(relaxing, at(-0.002), {});
  EXPECT_NEAR(contact.force_N(at(-0.002), {}).z(), 3 + 7, 1e-9) << "another surface begins as it is told";
}

TEST(SurfaceContact, CountsLessAndLessBeyondHalfItsRadiusAndNotBeyondIt) {
  local_model::Surface surface = still();
  surface.radius_m = 0.01;
  const SurfaceContact contact = contact_of(surface);
  const auto weight = [&](double x_m, double z_m) { return contact.weight({.place_m = {x_m, 0, z_m}}, {}); };
  EXPECT_EQ(weight(0.005, 0), 1);
  EXPECT_EQ(weight(0.005, 0.5), 1) << "above it, however far";
  EXPECT_NEAR(weight(0.0075, 0), 0.5, 1e-12);
  EXPECT_NEAR(weight(0, -0.0075), 0.5, 1e-12);
  EXPECT_EQ(weight(0.01, 0), 0);
  EXPECT_EQ(weight(1, 0), 0);
  EXPECT_EQ(weight(std::numeric_limits<double>::quiet_NaN(), 0), 0);
}

TEST(LinearField, IsAForceWithItsDerivativeWithinItsRadius) {
  const local_model::Field field = test::eddy();
  EXPECT_EQ(force_N(field, {.place_m = field.place_m}), field.force_N);
  const Point moved_m(0.01, 0.02, -0.01);
  EXPECT_TRUE(force_N(field, {.place_m = field.place_m + moved_m}).isApprox(Point(0.2, 0.4, 0.5)));
  EXPECT_EQ(weight(field, {.place_m = field.place_m}), 1);
  EXPECT_EQ(weight(field, {.place_m = field.place_m + Point(0.0625, 0, 0)}), 0);
}

}  // namespace
}  // namespace forcebound::client
