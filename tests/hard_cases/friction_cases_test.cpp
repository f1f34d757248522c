#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "forcebound/scene/effects/friction.hpp"
#include "tests/support/effect_probe.hpp"

namespace forcebound::server {
namespace {

constexpr double kStiffness_N_per_m = 700;
constexpr int kTicks = FORCEBOUND_FRICTION_TICKS;

std::unique_ptr<scene::Effect> friction(double static_coefficient, double dynamic_coefficient,
                                        double damping_N_s_per_m) {
  return scene::friction_effect().make({{"static_coefficient", static_coefficient},
                                        {"dynamic_coefficient", dynamic_coefficient},
                                        {"stiffness_N_per_m", kStiffness_N_per_m},
                                        {"damping_N_s_per_m", damping_N_s_per_m}});
}

scene::Probe pressed_at(const scene::Point& position_m, double pressure_N,
                        const scene::Point& normal = scene::Point::UnitZ()) {
  return {
      .position_m = position_m, .interval_s = 1e-3, .normal = normal, .penetration_m = 1e-3, .pressure_N = pressure_N};
}

TEST(HardCase36, FrictionAtRestDoesNotCreep) {
  const auto effect = friction(0.5, 0.4, 0);
  test::EffectProbe felt(*effect);
  (void)felt(pressed_at(scene::Point::Zero(), 2));
  const scene::Point held_N = felt(pressed_at({0.001, 0, 0}, 2)).force_N;
  EXPECT_NEAR(held_N.x(), -0.7, 1e-12);
  for (int i = 0; i < kTicks; ++i) {
    if (felt(pressed_at({0.001, 0, 0}, 2)).force_N != held_N) FAIL() << "crept on tick " << i;
  }
}

/// Random path, pressure and rotation of the surface.
void expect_dissipation_on_every_step(double quantum_m, double damping_N_s_per_m) {
  const auto effect = friction(0.6, 0.35, damping_N_s_per_m);
  test::EffectProbe felt(*effect);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> symmetric(-1, 1);
  const auto draw = [&] { return scene::Point(symmetric(random), symmetric(random), symmetric(random)); };
  scene::Point position_m = scene::Point::Zero();
  scene::Point seen_m = position_m;
  scene::Point normal = scene::Point::UnitZ();
  double stored_J = 0;
  double dissipated_J = 0;
  (void)felt(pressed_at(seen_m, 1, normal));
  for (int i = 0; i < kTicks; ++i) {
    const double speed = i / 1000 % 4 == 0 ? 0 : 1e-4 * (1 + i / 1000 % 7);
    position_m += speed * draw();
    const scene::Point now_m =
        quantum_m > 0 ? scene::Point((position_m / quantum_m).array().round() * quantum_m) : position_m;
    normal = (normal + 0.05 * draw()).normalized();
    const double pressure_N = std::max(0.0, 2 * symmetric(random));
    const scene::Point force_N = felt(pressed_at(now_m, pressure_N, normal)).force_N;
    ASSERT_LE(force_N.norm(), 0.6 * pressure_N * (1 + 1e-12)) << "tick " << i;
    // The hand's work against it; what is stored cannot be more than this force can have deflected the bristle.
    const double put_J = -force_N.dot(now_m - seen_m);
    const double spring_J = force_N.squaredNorm() / (2 * kStiffness_N_per_m);
    if (damping_N_s_per_m == 0) {
      ASSERT_GE(put_J - (spring_J - stored_J), -1e-15) << "tick " << i;
      stored_J = spring_J;
    }
    dissipated_J += put_J;
    ASSERT_GE(dissipated_J, -1e-9) << "tick " << i;
    seen_m = now_m;
  }
  EXPECT_GT(dissipated_J, 0.01);
}

TEST(HardCase36, FrictionNeverReturnsEnergyOnAnyStep) { expect_dissipation_on_every_step(0, 0); }
TEST(HardCase36, FrictionNeverReturnsEnergyWithQuantisedMotion) { expect_dissipation_on_every_step(15e-6, 0); }
TEST(HardCase36, FrictionOfADampedBristleNeverReturnsMoreThanItTook) { expect_dissipation_on_every_step(0, 2); }

TEST(HardCase36, FrictionUnderAnEncoderThatFlickersOneCountDoesNotChatter) {
  constexpr double kCount_m = 15e-6;
  const auto effect = friction(0.5, 0.3, 0);
  test::EffectProbe felt(*effect);
  (void)felt(pressed_at(scene::Point::Zero(), 2));
  (void)felt(pressed_at({0.0012, 0, 0}, 2));
  for (int i = 0; i < 10000; ++i) {
    const scene::Point force_N = felt(pressed_at({0.0012 + (i % 2) * kCount_m, 0, 0}, 2)).force_N;
    ASSERT_NEAR(force_N.x(), -0.84 - (i % 2) * kStiffness_N_per_m * kCount_m, 1e-9) << i;
  }
}

TEST(HardCase36, FrictionThroughStickSlipAndReversalStaysInItsCone) {
  const auto effect = friction(0.5, 0.3, 1);
  test::EffectProbe felt(*effect);
  int slips = 0;
  double last_N = 0;
  for (int i = 0; i < 100000; ++i) {
    const double x_m = 0.01 * std::sin(0.003 * i) + 0.001 * std::sin(0.11 * i);
    const double pressure_N = 1 + 0.9 * std::sin(0.017 * i);
    const double force_N = felt(pressed_at({x_m, 0, 0}, pressure_N)).force_N.norm();
    ASSERT_LE(force_N, 0.5 * pressure_N * (1 + 1e-12));
    slips += force_N < last_N - 0.05;
    last_N = force_N;
  }
  EXPECT_GT(slips, 10);
}

}  // namespace
}  // namespace forcebound::server
