#include "forcebound/device/simulated/simulated_device.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>
#include <random>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "tests/support/allocation_guard.hpp"

namespace forcebound::device {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

// The device must not depend on the origin of the caller's clock.
constexpr Nanoseconds kStart = std::chrono::hours(5) + Nanoseconds(123456789);

/// A hand at rest at the origin, or none at all with the default stiffness.
class StillHand final : public Operator {
 public:
  explicit StillHand(int dof, const Hand& hand = {}) : dof_(dof), hand_(hand) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "still"; }
  [[nodiscard]] const Hand& hand() const noexcept override { return hand_; }
  [[nodiscard]] int degrees_of_freedom() const noexcept override { return dof_; }
  [[nodiscard]] Target target(double) const noexcept override { return {Vector::Zero(dof_), Vector::Zero(dof_)}; }
  [[nodiscard]] std::string description() const override { return "still"; }

 private:
  int dof_;
  Hand hand_;
};

SimulatedDevice free_device(const std::string& toml_text) {
  DeviceDescription description = parse_device(toml_text, "test.toml");
  const int dof = description.facts.degrees_of_freedom();
  return {std::move(description), std::make_unique<StillHand>(dof)};
}

constexpr const char* kPointDevice =
    "kind = 'cartesian'\ndegrees_of_freedom = 1\nmass_kg = 0.1\ndamping_N_s_per_m = 5\nforce_N_max = 30\n";

Vector force(double newton) { return Vector::Constant(1, newton); }

/// Velocity of the point after `seconds` under 1 N from rest.
double speed_after(double seconds) { return -std::expm1(-50 * seconds) / 5; }

TEST(SimulatedDevice, StartsAtRestAtTheHandsFirstTargetWhateverTheClockSays) {
  SimulatedDevice device(load_device("wall-1dof"), make_operator("press:from_m=-0.012", 1));
  const Reading reading = device.read(kStart);
  EXPECT_NEAR(reading.position[0], -0.012, 1e-15);
  EXPECT_EQ(device.truth().joint_velocity[0], 0);
  EXPECT_EQ(device.audit()->energy_J, 0);
  EXPECT_FALSE(device.released_at());
}

TEST(SimulatedDevice, ForceTakesEffectAtOnceWithoutLatency) {
  SimulatedDevice device = free_device(kPointDevice);
  (void)device.read(kStart);
  device.apply(kStart, force(1));
  (void)device.read(kStart + milliseconds(1));
  EXPECT_NEAR(device.truth().joint_velocity[0], speed_after(1e-3), 1e-16);
}

TEST(SimulatedDevice, ForceTakesEffectALatencyAfterTheCommand) {
  SimulatedDevice device = free_device(std::string(kPointDevice) + "latency_s = 300e-6\n");
  (void)device.read(kStart);
  device.apply(kStart, force(1));
  (void)device.read(kStart + microseconds(300));
  EXPECT_EQ(device.truth().joint_velocity[0], 0);
  (void)device.read(kStart + milliseconds(1));
  EXPECT_NEAR(device.truth().joint_velocity[0], speed_after(0.7e-3), 1e-16);
}

TEST(SimulatedDevice, LatencyLongerThanThePeriodKeepsEveryCommandInItsTurn) {
  SimulatedDevice device = free_device(std::string(kPointDevice) + "latency_s = 2.5e-3\n");
  (void)device.read(kStart);
  device.apply(kStart, force(1));
  device.apply(kStart + milliseconds(1), force(0));
  (void)device.read(kStart + milliseconds(4));
  EXPECT_NEAR(device.truth().joint_velocity[0], speed_after(1e-3) * std::exp(-50 * 0.5e-3), 1e-16);
}

TEST(SimulatedDevice, ReleasesAForceThatIsNotRenewed) {
  SimulatedDevice device = free_device(kPointDevice);
  (void)device.read(kStart);
  device.apply(kStart, force(1));
  (void)device.read(kStart + microseconds(1999));
  EXPECT_FALSE(device.released_at());
  (void)device.read(kStart + milliseconds(10));
  ASSERT_TRUE(device.released_at());
  EXPECT_EQ(*device.released_at(), kStart + milliseconds(2));
  EXPECT_NEAR(device.truth().joint_velocity[0], speed_after(2e-3) * std::exp(-50 * 8e-3), 1e-16);
  device.apply(kStart + milliseconds(10), force(1));
  EXPECT_FALSE(device.released_at());
}

TEST(SimulatedDevice, HoldTimeCountsFromWhenTheForceTookEffect) {
  SimulatedDevice device = free_device(std::string(kPointDevice) + "latency_s = 300e-6\n");
  (void)device.read(kStart);
  device.apply(kStart, force(1));
  (void)device.read(kStart + milliseconds(10));
  ASSERT_TRUE(device.released_at());
  EXPECT_EQ(*device.released_at(), kStart + microseconds(2300));
}

TEST(SimulatedDevice, ReadsWholeEncoderSteps) {
  SimulatedDevice device = free_device(std::string(kPointDevice) + "encoder_step_m = 55e-6\n");
  (void)device.read(kStart);
  for (int tick = 1; tick < 200; ++tick) {
    device.apply(kStart + milliseconds(tick - 1), force(1));
    const double read = device.read(kStart + milliseconds(tick)).position[0];
    EXPECT_LE(std::abs(read - device.truth().position[0]), 27.5e-6 * (1 + 1e-12));
    EXPECT_NEAR(read / 55e-6, std::round(read / 55e-6), 1e-9);
  }
}

TEST(SimulatedDevice, FaultyCommandsAreZeroForceAndCounted) {
  SimulatedDevice device = free_device(kPointDevice);
  (void)device.read(kStart);
  for (const double faulty : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    device.apply(kStart, force(faulty));
  }
  device.apply(kStart, Vector::Zero(2));
  (void)device.read(kStart + milliseconds(1));
  EXPECT_EQ(device.truth().joint_velocity[0], 0);
  EXPECT_EQ(device.counters().faulty_commands, 3U);
}

TEST(SimulatedDevice, ClockThatRunsBackwardsMovesNothing) {
  SimulatedDevice device = free_device(kPointDevice);
  (void)device.read(kStart);
  device.apply(kStart, force(1));
  (void)device.read(kStart + milliseconds(1));
  const double before = device.truth().joint_velocity[0];
  (void)device.read(kStart);
  EXPECT_EQ(device.truth().joint_velocity[0], before);
}

TEST(SimulatedDevice, MotionDoesNotDependOnTheTimesOfReadings) {
  for (const char* name : {"wall-1dof", "cartesian-3dof"}) {
    SCOPED_TRACE(name);
    const DeviceDescription description = load_device(name);
    const int dof = description.facts.degrees_of_freedom();
    SimulatedDevice seldom(description, make_operator("wave", dof));
    SimulatedDevice often(description, make_operator("wave", dof));
    std::mt19937_64 random(1);
    std::uniform_int_distribution<int> nanoseconds(0, 999'999);
    for (int tick = 0; tick < 1000; ++tick) {
      const Nanoseconds now = kStart + tick * milliseconds(1);
      const Vector pull = Vector::Constant(dof, std::sin(0.01 * tick));
      (void)seldom.read(now);
      seldom.apply(now, pull);
      (void)often.read(now);
      often.apply(now, pull);
      std::array<int, 6> looks{};
      for (int& look : looks) look = nanoseconds(random);
      std::sort(looks.begin(), looks.end());
      for (const int look : looks) (void)often.read(now + Nanoseconds(look));
    }
    (void)seldom.read(kStart + std::chrono::seconds(1));
    (void)often.read(kStart + std::chrono::seconds(1));
    EXPECT_LT((seldom.truth().position - often.truth().position).norm(), 1e-12 * 0.03);
    EXPECT_LT((seldom.truth().joint_velocity - often.truth().joint_velocity).norm(), 1e-12);
    EXPECT_NEAR(seldom.audit()->energy_J, often.audit()->energy_J, 1e-12);
    EXPECT_NEAR(seldom.audit()->minimum_J, often.audit()->minimum_J, 1e-12);
  }
}

TEST(SimulatedDevice, AGapOfAnHourIsSimulatedForAMinuteAndCounted) {
  SimulatedDevice device(load_device("cartesian-3dof"), make_operator("wave", 3));
  (void)device.read(kStart);
  device.apply(kStart, Vector::Ones(3));
  const Reading reading = device.read(kStart + std::chrono::hours(1));
  EXPECT_TRUE(reading.position.allFinite());
  EXPECT_EQ(device.counters().gaps_cut, 1U);
  EXPECT_EQ(*device.released_at(), kStart + milliseconds(2));
  // The hand continues from where it stopped, not from where it would be after an hour.
  const Vector before = device.truth().position;
  (void)device.read(kStart + std::chrono::hours(1) + milliseconds(1));
  EXPECT_LT((device.truth().position - before).norm(), 1e-3);
}

TEST(SimulatedDevice, ArmWithAHandPassesOnTheTaskForceThroughItsJacobian) {
  // Held still by a stiff hand, the tip gives way by f / k.
  const Hand hand{.mass_kg = 0, .stiffness_N_per_m = 2000, .damping_N_s_per_m = 20};
  DeviceDescription description = load_device("omni");
  description.facts.friction.setZero();
  SimulatedDevice device(description, std::make_unique<StillHand>(3, hand));
  (void)device.read(kStart);
  Vector pull(3);
  pull << 1.0, -0.5, 0.7;
  for (int tick = 0; tick < 2000; ++tick) {
    const Nanoseconds now = kStart + tick * milliseconds(1);
    (void)device.read(now);
    device.apply(now, pull);
  }
  EXPECT_LT((device.truth().position - pull / hand.stiffness_N_per_m).norm(), 2e-6);
}

TEST(SimulatedDevice, ArmReadsPositionJacobianAndDampingFromItsEncoders) {
  SimulatedDevice device(load_device("omni"), make_operator("wave", 3));
  const ArmKinematics kinematics(std::get<ArmGeometry>(device.description().geometry));
  for (int tick = 0; tick < 500; ++tick) {
    const Reading reading = device.read(kStart + tick * milliseconds(1));
    ASSERT_EQ(reading.position, kinematics.position(reading.joint));
    ASSERT_EQ(reading.jacobian, kinematics.jacobian(reading.joint));
    const Matrix inverse = Eigen::Matrix3d(reading.jacobian).inverse();
    const Matrix expected = inverse.transpose() * device.facts().damping * inverse;
    ASSERT_LT((reading.damping->matrix() - expected).norm(), 1e-4 * expected.norm());
  }
}

TEST(SimulatedDevice, ArmShowsHalfANewtonSecondPerMeterInTheMiddleOfItsWorkspace) {
  SimulatedDevice device(load_device("omni"), std::make_unique<StillHand>(3));
  const Matrix damping = device.read(kStart).damping->matrix();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes{Eigen::Matrix3d(damping)};
  EXPECT_GT(axes.eigenvalues().minCoeff(), 0.35);
  EXPECT_LT(axes.eigenvalues().maxCoeff(), 0.9);
}

TEST(SimulatedDevice, ArmPulledFarOutOfReachStaysFinite) {
  for (const char* spec : {"press:axis=2,from_m=0,to_m=1.0,approach_s=0.3", "wave:amplitude_m=0.6,frequency_Hz=1.5",
                           "press:axis=2,from_m=0,to_m=-0.7,approach_s=0.3,stiffness_N_per_m=2000"}) {
    SCOPED_TRACE(spec);
    SimulatedDevice device(load_device("omni"), make_operator(spec, 3));
    for (int tick = 0; tick < 5000; ++tick) {
      const Nanoseconds now = kStart + tick * milliseconds(1);
      const Reading reading = device.read(now);
      ASSERT_TRUE(reading.position.allFinite());
      ASSERT_TRUE(reading.damping->matrix().allFinite());
      device.apply(now, Vector::Constant(3, tick % 2 ? 3.3 : -3.3));
    }
    EXPECT_LT(device.truth().position.norm(), 0.5);
    EXPECT_LT(device.truth().joint_velocity.norm(), 1e3);
  }
}

TEST(SimulatedDevice, AuditIsTheIntegralOfTheMotionThatResulted) {
  // By the trapezoidal rule over 10 us, with each force held for the 2 ms until it is released.
  constexpr Nanoseconds kStep = microseconds(10);
  for (const char* name : {"wall-1dof", "cartesian-3dof", "omni", "falcon", "haply-2diy"}) {
    SCOPED_TRACE(name);
    const DeviceDescription description = load_device(name);
    const int dof = description.facts.degrees_of_freedom();
    SimulatedDevice device(description, make_operator("wave", dof));
    Vector torque = Vector::Zero(dof);
    double energy = 0;
    double minimum = 0;
    SimulatedDevice::Truth before;
    for (int step = 0; step < 80'000; ++step) {
      const Nanoseconds now = kStart + step * kStep;
      const Reading reading = device.read(now);
      const SimulatedDevice::Truth truth = device.truth();
      if (step > 0) {
        const Vector moved = truth.joint - before.joint;
        const double power = before.joint_velocity.dot(description.facts.damping * before.joint_velocity) +
                             truth.joint_velocity.dot(description.facts.damping * truth.joint_velocity);
        energy += 0.5 * power * time::to_seconds(kStep) + description.facts.friction.dot(moved.cwiseAbs()) -
                  torque.dot(moved);
        minimum = std::min(minimum, energy);
      }
      before = truth;
      if (step % 500 == 200) torque.setZero();
      if (step % 500 != 0) continue;
      const Vector pull = Vector::Constant(dof, std::sin(1e-3 * step));
      device.apply(now, pull);
      torque = reading.jacobian.transpose() * pull;
    }
    EXPECT_NEAR(device.audit()->energy_J, energy, 1e-8);
    EXPECT_NEAR(device.audit()->minimum_J, minimum, 1e-8);
    EXPECT_LT(minimum, -1e-6);
  }
}

TEST(SimulatedDevice, HandWithTheWrongDegreesOfFreedomIsRefused) {
  try {
    SimulatedDevice device(load_device("wall-1dof"), make_operator("wave", 3));
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "operator 'wave' moves 3 degrees of freedom, device 'wall-1dof' has 1");
  }
}

TEST(SimulatedDevice, DeviceTooFastToFollowIsRefused) {
  DeviceDescription description = load_device("wall-1dof");
  description.inertia(0, 0) = 1e-6;
  EXPECT_THROW(SimulatedDevice(description, std::make_unique<StillHand>(1)), std::invalid_argument);
}

TEST(SimulatedDevice, ReadAndApplyDoNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const char* name :
       {"wall-1dof", "cartesian-2dof", "cartesian-3dof", "omni", "falcon", "omega-3", "haply-2diy"}) {
    SCOPED_TRACE(name);
    const DeviceDescription description = load_device(name);
    const int dof = description.facts.degrees_of_freedom();
    SimulatedDevice device(description, make_operator("wave", dof));
    const Vector pull = Vector::Constant(dof, 0.5);
    const test::AllocationGuard guard;
    for (int tick = 0; tick < 500; ++tick) {
      const Nanoseconds now = kStart + tick * microseconds(1100);
      (void)device.read(now);
      device.apply(now, pull);
    }
    EXPECT_EQ(guard.heap_operations(), 0U);
  }
}

}  // namespace
}  // namespace forcebound::device
