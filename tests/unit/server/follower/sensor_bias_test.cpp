#include "forcebound/server/follower/sensor_bias.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <optional>

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;

/// A sensor of 1 kHz with this wrench.
class Sensed {
 public:
  void run(Nanoseconds duration, const SensedForce& sensed, bool waits, bool stands) {
    for (const Nanoseconds end = now + duration; now < end; now += 1ms) {
      SensedForce sample = sensed;
      const double noise = now / 1ms % 2 == 0 ? 0.1 : -0.1;
      sample.force_N.x() += noise;
      sample.torque_N_m.y() += noise / 10;
      sample.sampled = now;
      bias.update({.now = now, .sensed = sample, .waits = waits, .stands = stands});
    }
  }
  [[nodiscard]] Vector6 left(const SensedForce& sensed) const { return *bias.without(sensed); }

  Nanoseconds now{1s};
  SensorBias bias{ForceSensorFacts{.period = 1ms, .noise_N_sd = 0.1, .noise_N_m_sd = 0.01}};
};

SensedForce force(double x_N, double y_N, double z_N) { return {.force_N = {x_N, y_N, z_N}}; }

TEST(SensorBias, IsThatOfForceAndTorqueWhileItLearns) {
  Sensed sensor;
  sensor.run(100ms, {.force_N = {1, 2, 3}, .torque_N_m = {0.1, 0.2, 0.3}}, true, false);
  Vector6 expected;
  expected << 0, 0, 5, 0, 0.5, 0;
  EXPECT_LT((sensor.left({.force_N = {1, 2, 8}, .torque_N_m = {0.1, 0.7, 0.3}}) - expected).norm(), 1e-9);
  EXPECT_FALSE(sensor.bias.without(std::nullopt));
  EXPECT_EQ(sensor.bias.status().learned, sensor.now - 1ms);
}

TEST(SensorBias, IsLearnedWhileItStandsAndNotWhileItTouches) {
  Sensed sensor;
  sensor.run(100ms, force(1, 2, 3), true, false);
  sensor.run(1s, force(1, 2, 3.4), false, false);
  EXPECT_NEAR(sensor.left(force(1, 2, 3.4))[2], 0.4, 1e-9) << "not while it is led";
  sensor.run(1s, force(1, 2, 3.4), false, true);
  EXPECT_NEAR(sensor.left(force(1, 2, 3.4))[2], 0, 1e-9);
  const auto learned = sensor.bias.status().learned;
  sensor.run(10s, force(1, 2, 8), false, true);
  EXPECT_NEAR(sensor.left(force(1, 2, 8))[2], 4.6, 0.1) << "somebody leans on it";
  EXPECT_LT(*sensor.bias.status().learned, *learned + 100ms);
  sensor.run(1s, force(1, 2, 3.4), false, true);
  EXPECT_NEAR(sensor.left(force(1, 2, 3.4))[2], 0, 0.05);
  EXPECT_GT(*sensor.bias.status().learned, *learned + 10s) << "and leans no more";
}

TEST(SensorBias, ASensorThatTellsNothingIsNamedInTheAnswer) {
  Sensed sensor;
  sensor.bias.command(sensor.now);
  sensor.bias.update({.now = sensor.now + SensorBias::kCommandMost});
  EXPECT_EQ(sensor.bias.status().answers, 0U);
  sensor.bias.update({.now = sensor.now + SensorBias::kCommandMost + 1ns});
  EXPECT_EQ(sensor.bias.status().answers, 1U);
  EXPECT_EQ(sensor.bias.status().answer, SensorBias::Answer::no_samples);
}

}  // namespace
}  // namespace forcebound::server
