#include "forcebound/client/rendering/texture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/vector_of.hpp"

namespace forcebound::client {
namespace {

using control::Vector;
using test::vector_of;

constexpr double kWave_rad_per_m = 2 * std::numbers::pi / 0.002;

/// A table at z = 0 with ripples every 2 mm along x, pressed 1 mm deep with 2 N.
wire::EnvironmentForce rippled() {
  return {.force = vector_of({0, 0, 2}),
          .position = vector_of({0, 0, -0.001}),
          .contact_normal = vector_of({0, 0, 1}),
          .penetration_m = 0.001,
          .texture_N = 0.5,
          .texture_wave = vector_of({kWave_rad_per_m, 0, 0})};
}

TEST(Texture, IsASineOfTheDevicesOwnPosition) {
  for (const double x : {0.0, 0.0005, 0.001, 0.0013, -0.0004}) {
    const Vector force = texture_force_N(rippled(), vector_of({x, 0.7, -0.001}));
    EXPECT_NEAR(force[2], 0.5 * std::sin(kWave_rad_per_m * x), 1e-15);
    EXPECT_EQ(force.head(2).norm(), 0);
  }
}

TEST(Texture, OfTwoWavesIsTheirMean) {
  auto grid = rippled();
  grid.texture_across = vector_of({0, kWave_rad_per_m, 0});
  const Vector force = texture_force_N(grid, vector_of({0.0005, 0.0005, -0.001}));
  EXPECT_NEAR(force[2], 0.5, 1e-15);
  EXPECT_NEAR(texture_force_N(grid, vector_of({0.0005, 0, -0.001}))[2], 0.25, 1e-15);
}

TEST(Texture, EndsWhereTheDeviceHasLeftTheSurfaceHoweverOldTheAnswer) {
  EXPECT_GT(texture_force_N(rippled(), vector_of({0.0005, 0, -0.0001})).norm(), 0.4);
  EXPECT_TRUE(texture_force_N(rippled(), vector_of({0.0005, 0, 0.0001})).isZero(0));
}

TEST(Texture, NeverPullsTogetherWithTheForceOfTheSurface) {
  auto light = rippled();
  light.force = vector_of({0.3, 0, 0.1});
  EXPECT_NEAR(texture_force_N(light, vector_of({-0.0005, 0, -0.001}))[2], -0.1, 1e-15);
}

TEST(Texture, NoTextureOrNoContactIsNoForce) {
  auto smooth = rippled();
  smooth.texture_N = 0;
  EXPECT_TRUE(texture_force_N(smooth, vector_of({0.0005, 0, -0.001})).isZero(0));
  auto free = rippled();
  free.contact_normal = {};
  EXPECT_TRUE(texture_force_N(free, vector_of({0.0005, 0, -0.001})).isZero(0));
  auto waveless = rippled();
  waveless.texture_wave = {};
  EXPECT_TRUE(texture_force_N(waveless, vector_of({0.0005, 0, -0.001})).isZero(0));
}

}  // namespace
}  // namespace forcebound::client
