#include "tests/tools/lab/trials/measures.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace forcebound::lab {
namespace {

using control::Vector;

void feed(RingingMeter& meter, int ms, double force_N, double penetration_m = 1e-3) {
  record::TickRecord tick;
  tick.time = std::chrono::milliseconds{ms};
  tick.applied = Vector::Constant(1, -force_N);
  tick.penetration_m = penetration_m;
  tick.contact = penetration_m > 0;
  meter.on_tick(tick);
}

TEST(RingingMeter, KnowsNothingWithoutContact) {
  RingingMeter meter;
  for (int ms = 0; ms < 1000; ++ms) feed(meter, ms, 0, -1e-3);
  EXPECT_FALSE(meter.ringing_s());
}

TEST(RingingMeter, ASteadyForceDoesNotRing) {
  RingingMeter meter;
  for (int ms = 0; ms < 1000; ++ms) feed(meter, ms, 5);
  EXPECT_EQ(meter.ringing_s(), 0.0);
}

TEST(RingingMeter, FindsWhenADecayingOscillationIsCalm) {
  // 2 A e^(-t/tau) < 20 % of 5 N from t = tau ln(2 A / 1 N) on: A = 4 N, tau = 100 ms: 208 ms.
  RingingMeter meter;
  for (int ms = 0; ms < 2000; ++ms) {
    if (ms < 100) {
      feed(meter, ms, 0, -1e-3);
    } else {
      const double t = (ms - 100) * 1e-3;
      feed(meter, ms, 5 + 4 * std::exp(-t / 0.1) * std::cos(2 * M_PI * 100 * t));
    }
  }
  ASSERT_TRUE(meter.ringing_s());
  EXPECT_NEAR(*meter.ringing_s(), 0.208, 0.02);
}

TEST(RingingMeter, AnOscillationThatNeverStopsRingsToTheEnd) {
  RingingMeter meter;
  for (int ms = 0; ms < 1000; ++ms) feed(meter, ms, ms % 2 == 0 ? 0 : 10);
  EXPECT_NEAR(*meter.ringing_s(), 0.999, 1e-9);
}

TEST(DirectionMeter, MeasuresSmallAnglesExactly) {
  DirectionMeter meter;
  record::TickRecord tick;
  tick.request = Vector::Unit(3, 0) * 7;
  tick.applied = (Vector::Unit(3, 0) + 3e-9 * Vector::Unit(3, 2)) * 0.1;
  meter.on_tick(tick);
  EXPECT_NEAR(meter.error_rad_max(), 3e-9, 1e-15);
}

TEST(DirectionMeter, LeavesOutZeroForcesAndSeesAReversal) {
  DirectionMeter meter;
  record::TickRecord tick;
  tick.request = Vector::Unit(2, 0);
  tick.applied = Vector::Zero(2);
  meter.on_tick(tick);
  EXPECT_EQ(meter.error_rad_max(), 0.0);
  tick.applied = -Vector::Unit(2, 0);
  meter.on_tick(tick);
  EXPECT_NEAR(meter.error_rad_max(), M_PI, 1e-12);
}

}  // namespace
}  // namespace forcebound::lab
