#include "forcebound/device/repeated_readings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace forcebound::device {
namespace {

constexpr double kTick_s = 1e-3;
constexpr double kEncoderStep = 1e-4;

/// One joint with an encoder.
struct Watched {
  void read(double place, int times = 1) {
    for (int i = 0; i < times; ++i)
      seen.add(Vector::Constant(1, kEncoderStep * std::round(place / kEncoderStep)), kTick_s);
  }
  RepeatedReadings seen{Vector::Constant(1, kEncoderStep)};
};

TEST(RepeatedReadings, CountsTheTimeSinceTheLastChange) {
  Watched joint;
  joint.read(0, 11);
  EXPECT_NEAR(joint.seen.still_s(0), 10 * kTick_s, 1e-12);
  joint.read(kEncoderStep);
  EXPECT_EQ(joint.seen.still_s(0), 0);
  EXPECT_EQ(joint.seen.velocity(0), 0) << "a step may take no speed at all";
}

TEST(RepeatedReadings, ASpeedIsTheLeastThatExplainsTheLastChange) {
  Watched joint;
  joint.read(0);
  joint.read(-10 * kEncoderStep);
  EXPECT_NEAR(joint.seen.velocity(0), -9 * kEncoderStep / kTick_s, 1e-9);
}

TEST(RepeatedReadings, WhatStopsWithinAStepFromAGreatSpeedDidNotStop) {
  Watched joint;
  joint.read(0);
  joint.read(10 * kEncoderStep);
  EXPECT_FALSE(joint.seen.cannot_have_stopped(0, 10)) << "it has only moved";
  joint.read(10 * kEncoderStep);
  EXPECT_TRUE(joint.seen.cannot_have_stopped(0, 10));
  EXPECT_FALSE(joint.seen.cannot_have_stopped(0, 1e4)) << "a rail's end stops it";
}

TEST(RepeatedReadings, NoDecelerationIsTakenForAFrozenReading) {
  for (const double deceleration : {0.5, 5.0, 50.0, 500.0, 5000.0}) {
    for (double speed = 0.01; speed < 3; speed *= 1.1) {
      for (double phase = 0; phase < 1; phase += 0.05) {
        Watched joint;
        const double stops_s = speed / deceleration;
        for (int tick = -5; tick < 3 + static_cast<int>(stops_s / kTick_s); ++tick) {
          const double time_s = (tick + phase) * kTick_s;
          const double braked_s = std::clamp(time_s, 0.0, stops_s);
          joint.read(speed * std::min(time_s, 0.0) + speed * braked_s - deceleration * braked_s * braked_s / 2);
          ASSERT_FALSE(joint.seen.cannot_have_stopped(0, deceleration))
              << speed << " per s, " << deceleration << " per s^2, " << phase;
        }
      }
    }
  }
}

TEST(RepeatedReadings, OfSeveralJointsEachCounts) {
  RepeatedReadings seen(Vector::Zero(2));
  Vector place = Vector::Zero(2);
  for (int i = 0; i < 4; ++i) {
    place[1] += 0.1;
    seen.add(place, kTick_s);
  }
  EXPECT_NEAR(seen.still_s(0), 3 * kTick_s, 1e-12);
  EXPECT_EQ(seen.still_s(1), 0);
}

}  // namespace
}  // namespace forcebound::device
