#include "forcebound/device/simulated/device_flaws.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"

namespace forcebound::device {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr Nanoseconds kBegin = std::chrono::seconds(7);

/// A point of 0.1 kg and 5 N s/m that no hand holds.
SimulatedDevice device_with(const DeviceFlaws& flaws, const std::string& more = "") {
  return {parse_device("kind = 'cartesian'\ndegrees_of_freedom = 1\nmass_kg = 0.1\ndamping_N_s_per_m = 5\n"
                       "force_N_max = 30\n" +
                           more,
                       "point.toml"),
          make_operator("wave:mass_kg=0,stiffness_N_per_m=0,damping_N_s_per_m=0", 1), flaws};
}

Vector newtons(double force_N) { return Vector::Constant(1, force_N); }

/// Of that point after a time under 1 N, from rest.
double speed_under_one_newton(double time_s, double damping_N_s_per_m = 5) {
  return (1 - std::exp(-damping_N_s_per_m / 0.1 * time_s)) / damping_N_s_per_m;
}

double speed_of(SimulatedDevice& device, Nanoseconds after) {
  (void)device.read(kBegin);
  device.apply(kBegin, newtons(1));
  (void)device.read(kBegin + after);
  return device.truth().joint_velocity[0];
}

TEST(DeviceFlaws, LeaveADeviceThatHasNoneAsItsFactsSay) {
  SimulatedDevice device = device_with({});
  EXPECT_NEAR(speed_of(device, milliseconds(1)), speed_under_one_newton(1e-3), 1e-15);
  EXPECT_EQ(bounds_of({}), control::Uncertainty{});
}

TEST(DeviceFlaws, LatchAReadingBeforeItsStamp) {
  SimulatedDevice device = device_with({.stamp_s = {-1e-4, -1e-4}});
  EXPECT_NEAR(speed_of(device, milliseconds(1)), speed_under_one_newton(0.9e-3), 1e-9);
  EXPECT_EQ(device.read(kBegin + milliseconds(2)).latched, kBegin + milliseconds(2));
}

TEST(DeviceFlaws, StampAReadingBeforeItIsLatched) {
  SimulatedDevice device = device_with({.stamp_s = {1e-4, 1e-4}});
  EXPECT_NEAR(speed_of(device, milliseconds(1)), speed_under_one_newton(1e-3), 1e-15);
  EXPECT_EQ(device.read(kBegin + milliseconds(2)).latched, kBegin + microseconds(1900));
}

TEST(DeviceFlaws, LetTheClockRunFasterThanTime) {
  SimulatedDevice device = device_with({.clock_share = 0.01});
  EXPECT_NEAR(speed_of(device, microseconds(1010)), speed_under_one_newton(1e-3), 1e-15);
}

TEST(DeviceFlaws, TakeInCommandsAndLatchReadingsOnceInAFrame) {
  SimulatedDevice device = device_with({.frame = microseconds(400)});
  (void)device.read(kBegin);
  device.apply(kBegin + microseconds(100), newtons(1));
  const Reading reading = device.read(kBegin + microseconds(1100));
  EXPECT_EQ(reading.latched, kBegin + microseconds(1100));
  EXPECT_NEAR(device.truth().joint_velocity[0], speed_under_one_newton(0.7e-3), 1e-15);
  const double force_N = 1;
  const double then_s = 0.4e-3;
  EXPECT_NEAR(reading.joint[0], force_N / 5 * (then_s - speed_under_one_newton(then_s) * 0.1), 1e-15);
  EXPECT_EQ(bounds_of({.frame = microseconds(400)}),
            (control::Uncertainty{.stamp_s = {-400e-6, 0}, .latency_s = {0, 400e-6}}));
}

TEST(DeviceFlaws, LetGoEarlyAndSayNothing) {
  SimulatedDevice device = device_with({.hold_s = {-0.5e-3, -0.5e-3}, .releases_reported = false});
  EXPECT_NEAR(speed_of(device, milliseconds(3)), speed_under_one_newton(1.5e-3) * std::exp(-50 * 1.5e-3), 1e-15);
  EXPECT_FALSE(device.released_at());
}

TEST(DeviceFlaws, ReportAnEffectOnceItIsThere) {
  SimulatedDevice device = device_with({.latency_s = {3e-4, 3e-4}, .effects_reported = true});
  (void)device.read(kBegin);
  device.apply(kBegin, newtons(1));
  (void)device.read(kBegin + microseconds(299));
  EXPECT_FALSE(device.effective_at());
  (void)device.read(kBegin + microseconds(301));
  EXPECT_EQ(device.effective_at(), kBegin + microseconds(300));
  device.apply(kBegin + microseconds(301), newtons(2));
  EXPECT_FALSE(device.effective_at()) << "that of the command before is not this one's";
}

TEST(DeviceFlaws, LoseACommandAndSaySoOrNot) {
  for (const bool reported : {false, true}) {
    SimulatedDevice device = device_with({.failed_writes = 1, .failures_reported = reported});
    EXPECT_EQ(speed_of(device, milliseconds(1)), 0);
    EXPECT_EQ(device.write_failed(), reported);
    EXPECT_EQ(device.counters().failed_writes, 1U);
  }
}

TEST(DeviceFlaws, TakeFromDampingInTheMotionAndInTheAudit) {
  SimulatedDevice device = device_with({.damping_share = 0.2});
  EXPECT_NEAR(speed_of(device, milliseconds(1)), speed_under_one_newton(1e-3, 4), 1e-15);
}

TEST(DeviceFlaws, LetTheTorqueFollowTheCommandNoSlowerThanTheLag) {
  SimulatedDevice lagging = device_with({.actuator_lag_s = 2e-4});
  const double speed = speed_of(lagging, milliseconds(1));
  EXPECT_LT(speed, speed_under_one_newton(1e-3) * 0.9);
  EXPECT_GT(speed, speed_under_one_newton(0.8e-3) * 0.95) << "a lag takes as much as a delay of its time constant";
}

TEST(DeviceFlaws, AddToTheTorqueAlongWithTheMotion) {
  SimulatedDevice device = device_with({.torque_ripple_share = 0.1});
  EXPECT_NEAR(speed_of(device, milliseconds(1)), 1.1 * speed_under_one_newton(1e-3), 1e-12);
}

TEST(DeviceFlaws, MultiplyEachTorqueByOneConstant) {
  SimulatedDevice device = device_with({.torque_gain_share = {0.1, 0.1}});
  EXPECT_NEAR(speed_of(device, milliseconds(1)), 1.1 * speed_under_one_newton(1e-3), 1e-12);
}

TEST(DeviceFlaws, DelayAllForcesByOneConstant) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SimulatedDevice device = device_with({.seed = seed, .latency_offset_s = {1e-4, 3e-4}, .effects_reported = true});
    (void)device.read(kBegin);
    Nanoseconds first{0};
    for (int tick = 0; tick < 5; ++tick) {
      const Nanoseconds now = kBegin + tick * milliseconds(1);
      device.apply(now, newtons(1));
      (void)device.read(now + microseconds(900));
      const Nanoseconds later = device.effective_at().value() - now;
      if (tick == 0) first = later;
      EXPECT_EQ(later, first);
    }
    EXPECT_GE(first, microseconds(100));
    EXPECT_LE(first, microseconds(300));
  }
}

TEST(DeviceFlaws, LoseCountsForGood) {
  SimulatedDevice device = device_with({.lost_counts = 1}, "encoder_step_m = 1e-3\n");
  (void)device.read(kBegin);
  const double first = device.read(kBegin + milliseconds(1)).joint[0];
  const double second = device.read(kBegin + milliseconds(2)).joint[0];
  EXPECT_NEAR(std::abs(second - first), 1e-3, 1e-12);
}

TEST(SimulatedDevice, ReleasesAForceInTheStagesOfItsFacts) {
  SimulatedDevice device = device_with({}, "release_share = 0.5\nrelease_s = 0.001\n");
  const double full = speed_under_one_newton(2e-3);
  const double part = full * std::exp(-50 * 1e-3) + 0.5 * speed_under_one_newton(1e-3);
  EXPECT_NEAR(speed_of(device, milliseconds(4)), part * std::exp(-50 * 1e-3), 1e-15);
  EXPECT_EQ(device.released_at(), kBegin + milliseconds(2));
}

}  // namespace
}  // namespace forcebound::device
