#include "forcebound/server/effects/surface.hpp"

#include <gtest/gtest.h>

#include <array>

namespace forcebound::server {
namespace {

std::unique_ptr<Effect> surface(double stiffness_N_per_m, double damping_N_s_per_m) {
  const std::array values{stiffness_N_per_m, damping_N_s_per_m};
  return surface_effect().make(values);
}

Probe probe(double penetration_m, const Point& velocity_m_per_s) {
  return {.position_m = Point::Zero(),
          .velocity_m_per_s = velocity_m_per_s,
          .normal = Point::UnitZ(),
          .penetration_m = penetration_m};
}

TEST(Surface, PushesOutLikeASpring) {
  const auto effect = surface(2000, 0);
  EXPECT_TRUE(effect->force_N(probe(0.003, {1, 2, 3})).isApprox(Point(0, 0, 6), 1e-15));
}

TEST(Surface, DampsAlongTheNormalOnly) {
  const auto effect = surface(2000, 5);
  EXPECT_TRUE(effect->force_N(probe(0.003, {0, 0, -0.2})).isApprox(Point(0, 0, 7), 1e-15));
  EXPECT_TRUE(effect->force_N(probe(0.003, {9, -9, 0.2})).isApprox(Point(0, 0, 5), 1e-15));
}

TEST(Surface, NeverPulls) {
  const auto effect = surface(2000, 5);
  EXPECT_EQ(effect->force_N(probe(0.003, {0, 0, 100})), Point(0, 0, 0));
}

TEST(Surface, LooksAtVelocityOnlyIfItDamps) {
  EXPECT_FALSE(surface(1, 0)->needs_velocity());
  EXPECT_TRUE(surface(1, 0.1)->needs_velocity());
}

}  // namespace
}  // namespace forcebound::server
