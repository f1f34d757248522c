#include "tests/tools/lab/trials/measures.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "forcebound/control/rotation.hpp"

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

/// Turned about x by an angle, and turned back by a stiffness beyond a torque that is always there.
void feed(RotationalStiffness& meter, double angle_rad, double stiffness_N_m_per_rad, bool contact = true) {
  record::TickRecord tick;
  tick.contact = contact;
  tick.applied_torque_N_m = Eigen::Vector3d(0.1 - stiffness_N_m_per_rad * angle_rad, 0.2, 0);
  tick.handle.orientation = control::orientation_of(control::turn_by(Eigen::Vector3d(angle_rad, 0, 0)));
  meter.on_tick(tick);
}

TEST(RotationalStiffness, IsTheTorqueForEachRadianInContact) {
  RotationalStiffness meter;
  for (int i = 0; i < 500; ++i) feed(meter, 0.3 + 0.1 * std::sin(0.05 * i), 1.5, i < 400);
  for (int i = 0; i < 100; ++i) feed(meter, 0.01 * i, 40, false);
  ASSERT_TRUE(meter.stiffness_N_m_per_rad());
  EXPECT_NEAR(*meter.stiffness_N_m_per_rad(), 1.5, 1e-9);
}

TEST(RotationalStiffness, IsNotKnownWithoutTorqueContactOrTurning) {
  RotationalStiffness meter;
  EXPECT_FALSE(meter.stiffness_N_m_per_rad());
  for (int i = 0; i < 100; ++i) feed(meter, 0.01 * i, 1, false);
  EXPECT_FALSE(meter.stiffness_N_m_per_rad()) << "no contact";
  record::TickRecord without_torque;
  without_torque.contact = true;
  without_torque.handle.orientation = control::Handle::Orientation{1, 0, 0, 0};
  meter.on_tick(without_torque);
  EXPECT_FALSE(meter.stiffness_N_m_per_rad()) << "no torque";
  for (int i = 0; i < 100; ++i) feed(meter, 1e-5 * (i % 2), 1);
  EXPECT_FALSE(meter.stiffness_N_m_per_rad()) << "no turning";
}

}  // namespace
}  // namespace forcebound::lab
