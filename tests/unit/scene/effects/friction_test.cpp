#include "forcebound/scene/effects/friction.hpp"

#include <gtest/gtest.h>

#include "tests/support/effect_probe.hpp"

namespace forcebound::scene {
namespace {

constexpr double kStiffness_N_per_m = 500;

std::unique_ptr<Effect> friction(double coefficient, double dynamic = -1, double damping_N_s_per_m = 0) {
  return friction_effect().make({{"static_coefficient", coefficient},
                                 {"dynamic_coefficient", dynamic},
                                 {"stiffness_N_per_m", kStiffness_N_per_m},
                                 {"damping_N_s_per_m", damping_N_s_per_m}});
}

Probe pressed_at(double x_m, double pressure_N) {
  return {.position_m = Point(x_m, 0, -0.001),
          .interval_s = 1e-3,
          .normal = Point::UnitZ(),
          .penetration_m = 0.001,
          .pressure_N = pressure_N};
}

TEST(Friction, HoldsLikeASpringBeforeItSlips) {
  const auto effect = friction(0.5);
  test::EffectProbe felt(*effect);
  EXPECT_EQ(felt(pressed_at(0.01, 2)).force_N, Point(0, 0, 0)) << "the first touch has no deflection";
  EXPECT_NEAR(felt(pressed_at(0.011, 2)).force_N.x(), -0.5, 1e-12);
  EXPECT_NEAR(felt(pressed_at(0.012, 2)).force_N.x(), -1, 1e-12) << "just before it slips";
  EXPECT_NEAR(felt(pressed_at(0.010, 2)).force_N.x(), 0, 1e-12) << "and back";
}

TEST(Friction, SlipsAtTheCoefficientTimesThePressure) {
  const auto effect = friction(0.5);
  test::EffectProbe felt(*effect);
  (void)felt(pressed_at(0, 2));
  for (int i = 1; i < 100; ++i) {
    const Point force = felt(pressed_at(0.01 * i, 0.1 * i)).force_N;
    EXPECT_NEAR(force.x(), -0.05 * i, 1e-12);
    EXPECT_EQ(force.z(), 0);
  }
}

TEST(Friction, DropsToTheDynamicCoefficientWhenItSlipsAndSticksAgainBelowIt) {
  const auto effect = friction(0.8, 0.5);
  test::EffectProbe felt(*effect);
  (void)felt(pressed_at(0, 1));
  EXPECT_NEAR(felt(pressed_at(0.0015, 1)).force_N.x(), -0.75, 1e-12) << "sticks above mu_d";
  EXPECT_NEAR(felt(pressed_at(0.0017, 1)).force_N.x(), -0.5, 1e-12) << "slips";
  EXPECT_NEAR(felt(pressed_at(0.0019, 1)).force_N.x(), -0.5, 1e-12) << "slips on";
  EXPECT_NEAR(felt(pressed_at(0.0018, 1)).force_N.x(), -0.45, 1e-12) << "turned back: sticks";
  EXPECT_NEAR(felt(pressed_at(0.0022, 1)).force_N.x(), -0.65, 1e-12) << "sticks up to mu_s again";
}

TEST(Friction, ReversalCostsTwiceTheDeflectionAndThenTheFullForceTheOtherWay) {
  const auto effect = friction(0.5);
  test::EffectProbe felt(*effect);
  (void)felt(pressed_at(0, 2));
  EXPECT_NEAR(felt(pressed_at(0.05, 2)).force_N.x(), -1, 1e-12);
  EXPECT_NEAR(felt(pressed_at(0.046, 2)).force_N.x(), 1, 1e-12) << "2 mm of deflection, both ways";
  EXPECT_NEAR(felt(pressed_at(0.01, 2)).force_N.x(), 1, 1e-12);
}

TEST(Friction, OfADampedBristleResistsSpeedWhileItSticks) {
  const auto effect = friction(10, -1, 3);
  test::EffectProbe felt(*effect);
  (void)felt(pressed_at(0, 2));
  // 0.1 mm in 1 ms: 0.05 N of the spring, 0.3 N of the damper.
  EXPECT_NEAR(felt(pressed_at(0.0001, 2)).force_N.x(), -0.35, 1e-12);
  EXPECT_NEAR(felt(pressed_at(0.0001, 2)).force_N.x(), -0.05, 1e-12);
}

TEST(Friction, IgnoresMotionAlongTheNormal) {
  const auto effect = friction(0.5);
  test::EffectProbe felt(*effect);
  Probe probe = pressed_at(0, 2);
  (void)felt(probe);
  probe.position_m.z() = -0.05;
  EXPECT_TRUE(felt(probe).force_N.isZero(0));
}

TEST(Friction, WithoutPressureIsNothing) {
  const auto effect = friction(0.5);
  test::EffectProbe felt(*effect);
  (void)felt(pressed_at(0, 2));
  (void)felt(pressed_at(0.001, 2));
  EXPECT_EQ(felt(pressed_at(0.001, 0)).force_N.norm(), 0);
  EXPECT_EQ(felt(pressed_at(0.001, 2)).force_N.norm(), 0) << "and forgets its deflection";
}

TEST(Friction, RefusesADynamicCoefficientAboveTheStaticOne) {
  EXPECT_THROW(friction(0.5, 0.6), std::invalid_argument);
  EXPECT_NO_THROW(friction(0.5, 0.5));
  EXPECT_NO_THROW(friction(0.5, 0));
}

TEST(Friction, AsksForTimeOnlyIfItsBristleIsDamped) {
  EXPECT_FALSE(friction(0.5)->facts().inputs.time);
  EXPECT_TRUE(friction(0.5, -1, 1)->facts().inputs.time);
  EXPECT_TRUE(friction(0.5)->facts().inputs.pressure);
}

}  // namespace
}  // namespace forcebound::scene
