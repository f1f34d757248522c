#include "forcebound/server/robot/force_sensor.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

namespace forcebound::server {
namespace {

constexpr ForceSensorFacts kFacts{.period = std::chrono::milliseconds(2),
                                  .noise_N_sd = 0.15,
                                  .noise_N_m_sd = 0.005,
                                  .bias_N_max = 0.5,
                                  .bias_N_m_max = 0.02};

TEST(ForceSensor, SamplesAtItsOwnRate) {
  ForceSensor sensor(kFacts, 1);
  EXPECT_FALSE(sensor.newest().has_value());
  sensor.pass(std::chrono::microseconds(500), Vector6::Zero());
  EXPECT_EQ(sensor.newest()->sampled, Nanoseconds(0));
  const Eigen::Vector3d first = sensor.newest()->force_N;
  sensor.pass(std::chrono::microseconds(1900), Vector6::Ones());
  EXPECT_EQ(sensor.newest()->force_N, first);
  sensor.pass(std::chrono::microseconds(2300), Vector6::Ones());
  EXPECT_EQ(sensor.newest()->sampled, std::chrono::milliseconds(2));
  EXPECT_NE(sensor.newest()->force_N, first);
}

TEST(ForceSensor, HasTheNoiseAndTheBiasOfItsFacts) {
  ForceSensor sensor(kFacts, 7);
  constexpr int kSamples = 20000;
  double sum = 0;
  double squares = 0;
  for (int i = 0; i < kSamples; ++i) {
    sensor.pass(i * kFacts.period, Vector6::Constant(10));
    const double off = sensor.newest()->force_N.x() - 10;
    sum += off;
    squares += off * off;
  }
  const double bias = sum / kSamples;
  const double sd = std::sqrt(squares / kSamples - bias * bias);
  EXPECT_NEAR(sd, 0.15, 0.005);
  EXPECT_LE(std::abs(bias), 0.5 + 0.01);
  EXPECT_GT(std::abs(bias), 0.01) << "this seed draws one that can be seen";
}

TEST(ForceSensor, IsTheSameForTheSameSeed) {
  ForceSensor first(kFacts, 3);
  ForceSensor second(kFacts, 3);
  ForceSensor other(kFacts, 4);
  for (ForceSensor* sensor : {&first, &second, &other}) sensor->pass(Nanoseconds(0), Vector6::Zero());
  EXPECT_EQ(first.newest()->force_N, second.newest()->force_N);
  EXPECT_NE(first.newest()->force_N, other.newest()->force_N);
}

}  // namespace
}  // namespace forcebound::server
