#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "forcebound/answer/answer.hpp"
#include "tests/support/vector_of.hpp"

namespace forcebound::answer {
namespace {

using test::vector_of;

constexpr double kWave_rad_per_m = 2 * std::numbers::pi / 0.002;

/// A table at z = 0 with ripples every 2 mm along x, pressed 1 mm deep with 2 N.
Answer rippled() {
  return {.force = vector_of({0, 0, 2}),
          .contact_normal = vector_of({0, 0, 1}),
          .penetration_m = 0.001,
          .texture_N = 0.5,
          .texture_wave = vector_of({kWave_rad_per_m, 0, 0})};
}

Vector ripples_at(const Vector& position, const Answer& answer) {
  const Vector answered_at = vector_of({0, 0, -0.001});
  return ripples_N(answer, {.answered_at = answered_at, .position = position, .pushing_N = answer.force});
}

TEST(Ripples, AreASineOfTheDevicesOwnPosition) {
  for (const double x : {0.0, 0.0005, 0.001, 0.0013, -0.0004}) {
    const Vector force = ripples_at(vector_of({x, 0.7, -0.001}), rippled());
    EXPECT_NEAR(force[2], 0.5 * std::sin(kWave_rad_per_m * x), 1e-15);
    EXPECT_EQ(force.head(2).norm(), 0);
  }
}

TEST(Ripples, OfTwoWavesAreTheirMean) {
  auto grid = rippled();
  grid.texture_across = vector_of({0, kWave_rad_per_m, 0});
  const Vector force = ripples_at(vector_of({0.0005, 0.0005, -0.001}), grid);
  EXPECT_NEAR(force[2], 0.5, 1e-15);
  EXPECT_NEAR(ripples_at(vector_of({0.0005, 0, -0.001}), grid)[2], 0.25, 1e-15);
}

TEST(Ripples, EndWhereTheDeviceHasLeftTheSurfaceHoweverOldTheAnswer) {
  EXPECT_GT(ripples_at(vector_of({0.0005, 0, -0.0001}), rippled()).norm(), 0.4);
  EXPECT_TRUE(ripples_at(vector_of({0.0005, 0, 0.0001}), rippled()).isZero(0));
}

TEST(Ripples, NeverPullTogetherWithTheForceOfTheSurface) {
  auto light = rippled();
  light.force = vector_of({0.3, 0, 0.1});
  EXPECT_NEAR(ripples_at(vector_of({-0.0005, 0, -0.001}), light)[2], -0.1, 1e-15);
}

TEST(Ripples, WithoutTextureOrContactAreNoForce) {
  auto smooth = rippled();
  smooth.texture_N = 0;
  EXPECT_TRUE(ripples_at(vector_of({0.0005, 0, -0.001}), smooth).isZero(0));
  auto free = rippled();
  free.contact_normal = {};
  EXPECT_TRUE(ripples_at(vector_of({0.0005, 0, -0.001}), free).isZero(0));
  auto waveless = rippled();
  waveless.texture_wave = {};
  EXPECT_TRUE(ripples_at(vector_of({0.0005, 0, -0.001}), waveless).isZero(0));
}

}  // namespace
}  // namespace forcebound::answer
