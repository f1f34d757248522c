#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <array>
#include <cmath>
#include <deque>
#include <memory>
#include <random>
#include <string>

#include "forcebound/control/exact_law.hpp"
#include "forcebound/control/force_bounder.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/control/rotation.hpp"
#include "forcebound/control/wrench.hpp"
#include "forcebound/device/command_times.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "tests/support/allocation_guard.hpp"

namespace forcebound::device {
namespace {

using std::chrono::milliseconds;

constexpr Nanoseconds kSixAxesStart = std::chrono::hours(1);

/// A shipped device of six axes, a hand and a law, tick by tick as a client runs them.
class SixAxes {
 public:
  SixAxes(const std::string& hand, const std::string& law, const DeviceFlaws& flaws = {}, const char* name = "arm-6dof")
      : device_(facts_with(name, bounds_of(flaws)), make_operator(hand, 3, true), flaws),
        times_(device_),
        bounder_(device_.facts(), control::force_bounding_laws().make(law, device_.facts())) {}

  /// @param wrench_at of a reading: what is asked for
  template <class Environment>
  void tick(Environment&& wrench_at) {
    const Nanoseconds now = kSixAxesStart + ticks_++ * milliseconds(1);
    const Reading reading = usable_or_lost(device_.read(now), device_.facts(), now, now);
    times_.begin_choosing(now);
    const control::Motion motion = times_.motion_at(reading);
    position_ = motion.position;
    const Vector chosen = bounder_.tick(motion, wrench_at(reading));
    applied_ = bounder_.confirmed(chosen, times_.command_at(reading, now));
    device_.apply(now, applied_);
  }

  [[nodiscard]] const SimulatedDevice& device() const { return device_; }
  [[nodiscard]] const Vector& applied() const { return applied_; }
  /// As the law is told of it.
  [[nodiscard]] const Vector& position() const { return position_; }
  [[nodiscard]] double least_J() const { return device_.audit()->minimum_J; }

 private:
  static DeviceDescription facts_with(const char* name, const control::Uncertainty& uncertainty) {
    DeviceDescription description = load_device(name);
    description.facts.uncertainty = uncertainty;
    return description;
  }

  SimulatedDevice device_;
  CommandTimes times_;
  control::ForceBounder bounder_;
  Vector applied_;
  Vector position_;
  int ticks_ = 0;
};

/// Springs to the origin and to the scene's axes, of what was some ticks ago; what is lost is held.
class LateSprings {
 public:
  LateSprings(double stiffness_N_per_m, double stiffness_N_m_per_rad, std::uint64_t seed = 1)
      : force_N_per_m_(stiffness_N_per_m), torque_N_m_per_rad_(stiffness_N_m_per_rad), random_(seed) {}

  Vector operator()(const Reading& reading) {
    const Eigen::Vector3d turned =
        control::rotation_vector(control::quaternion_of(*reading.handle.orientation), Eigen::Quaterniond::Identity());
    const Vector wrench = control::wrench_of(-force_N_per_m_ * reading.position, torque_N_m_per_rad_ * turned, 3);
    on_their_way_.push_back(wrench);
    std::uniform_real_distribution<double> share(0, 1);
    // Delays of 3 to 40 ticks that change, bursts and losses.
    if (share(random_) < 0.02) delay_ = static_cast<std::size_t>(3 + 37 * share(random_));
    const bool lost = share(random_) < 0.2;
    while (on_their_way_.size() > delay_) {
      if (!lost) arrived_ = on_their_way_.front();
      on_their_way_.pop_front();
    }
    return arrived_;
  }

 private:
  double force_N_per_m_;
  double torque_N_m_per_rad_;
  std::mt19937_64 random_;
  std::deque<Vector> on_their_way_;
  std::size_t delay_ = 15;
  Vector arrived_ = Vector::Zero(6);
};

Vector nothing(const Reading& /*reading*/) { return Vector::Zero(6); }

TEST(SixAxesDevice, FollowsAHandThatTurnsIt) {
  SixAxes run("press:from_m=0,to_m=0,turn_x_rad=0.4,turn_y_rad=0.3,turn_z_rad=0.5,turn_Hz=0.4", "none");
  double turned_most = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    run.tick(nothing);
    const Eigen::Vector3d wanted = run.device().hand().turn(tick * 1e-3);
    const auto turned = ChainKinematics(std::get<ChainGeometry>(run.device().description().geometry))
                            .orientation(run.device().truth().joint);
    ASSERT_LT(control::rotation_vector(*turned, control::turn_by(wanted)).norm(), 0.08) << tick;
    turned_most = std::max(turned_most, wanted.norm());
  }
  EXPECT_GT(turned_most, 0.5);
}

TEST(SixAxesDevice, TellsTheLawHowFarItTurnedAboutTheLastPose) {
  SixAxes run("press:from_m=0,to_m=0,turn_x_rad=0.4,turn_z_rad=0.5", "none");
  Vector before;
  Eigen::Quaterniond pose_before;
  for (int tick = 0; tick < 2000; ++tick) {
    Eigen::Quaterniond pose;
    run.tick([&](const Reading& reading) {
      pose = control::quaternion_of(*reading.handle.orientation);
      return Vector(Vector::Zero(6));
    });
    ASSERT_EQ(run.position().rows(), 6);
    if (tick > 0) {
      const Vector step = (run.position() - before).tail<3>();
      ASSERT_LT((step - control::rotation_vector(pose_before, pose)).norm(), 1e-12) << tick;
    }
    before = run.position();
    pose_before = pose;
  }
}

TEST(SixAxesDevice, AuditCountsTheTorqueTimesTheAngularVelocity) {
  DeviceDescription description = load_device("arm-6dof");
  SimulatedDevice device(description, make_operator("press:from_m=0,to_m=0,turn_x_rad=0.2,turn_y_rad=0.3", 3, true));
  Vector wrench(6);
  double balance_J = 0;
  constexpr double kDifference_s = 1e-5;
  for (int step = 0; step < 100'000; ++step) {
    const Nanoseconds now = kSixAxesStart + step * std::chrono::microseconds(10);
    if (step % 100 == 0) {
      const double t = step * kDifference_s;
      wrench << std::sin(20 * t), 1, std::cos(9 * t), 0.1 * std::sin(8 * t), 0.1, -0.1 * std::cos(11 * t);
      (void)device.read(now);
      device.apply(now, wrench);
    } else {
      (void)device.read(now);
    }
    const SimulatedDevice::Truth truth = device.truth();
    const Vector& speed = truth.joint_velocity;
    balance_J += kDifference_s *
                 (speed.dot(description.facts.damping * speed) + description.facts.friction.dot(speed.cwiseAbs()) -
                  wrench.head<3>().dot(truth.velocity) - wrench.tail<3>().dot(truth.turning));
  }
  EXPECT_GT(std::abs(balance_J), 1e-3);
  EXPECT_NEAR(device.audit()->energy_J, balance_J, 0.02 * std::abs(balance_J));
}

TEST(SixAxesDevice, IsPassiveWithTheExactLawAndNotWithoutOneAtALateRotationSpring) {
  const std::string hand = "press:from_m=0,to_m=0,turn_x_rad=0.3,turn_y_rad=0.2,turn_Hz=1";
  const auto least_J_with = [&](const char* law, const char* device) {
    SixAxes run(hand, law, {}, device);
    LateSprings springs(0, 5);
    double torque_N_m = 0;
    for (int tick = 0; tick < 4000; ++tick) {
      run.tick(springs);
      torque_N_m = std::max(torque_N_m, run.applied().tail<3>().norm());
      EXPECT_LE(run.applied().tail<3>().norm(), run.device().facts().torque_N_m_max * (1 + 1e-12));
    }
    EXPECT_GT(torque_N_m, 0.02) << law << ": or nothing was shown";
    return run.least_J();
  };
  for (const char* const device : {"arm-6dof", "premium-6dof"}) {
    SCOPED_TRACE(device);
    EXPECT_GE(least_J_with("fba-exact", device), -1e-9);
    EXPECT_LT(least_J_with("none", device), -1e-3);
  }
}

TEST(SixAxesDevice, IsPassiveWithTheExactLawForAnyRestlessHandAndNetwork) {
  rc::check([] {
    const auto between = [](double low, double high) {
      return std::to_string(low + (high - low) * 1e-3 * *rc::gen::inRange(0, 1001));
    };
    const std::string hand = "wave:amplitude_m=" + between(0, 0.04) + ",frequency_Hz=" + between(0.2, 3) +
                             ",stiffness_N_per_m=" + between(50, 600) + ",turn_x_rad=" + between(-0.5, 0.5) +
                             ",turn_y_rad=" + between(-0.5, 0.5) + ",turn_z_rad=" + between(-0.5, 0.5) +
                             ",turn_Hz=" + between(0.2, 4) + ",rotation_stiffness_N_m_per_rad=" + between(0.1, 3);
    RC_LOG() << hand << std::endl;
    DeviceFlaws flaws;
    flaws.seed = *rc::gen::inRange(1, 1'000'000);
    if (*rc::gen::inRange(0, 2) == 1) {
      flaws.stamp_s = {-2e-4, 0};
      flaws.latency_s = {0, 1e-4};
      flaws.damping_share = 0.2;
      flaws.friction_share = 0.3;
      flaws.torque_ripple_share = 0.05;
      flaws.encoder_steps = 0.3;
    }
    SixAxes run(hand, "fba-exact", flaws);
    LateSprings springs(*rc::gen::inRange(0, 4000), 0.01 * *rc::gen::inRange(0, 1500), flaws.seed);
    for (int tick = 0; tick < 1200; ++tick) run.tick(springs);
    RC_ASSERT(run.least_J() >= -1e-9);
  });
}

TEST(SixAxesDevice, TicksWithoutAllocating) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  SixAxes run("wave:turn_x_rad=0.3,turn_z_rad=0.2", "fba-exact");
  Vector pull(6);
  pull << 1, 0.5, -0.5, 0.05, -0.05, 0.1;
  const test::AllocationGuard guard;
  for (int tick = 0; tick < 500; ++tick) run.tick([&](const Reading& /*reading*/) { return pull; });
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST(SixAxesDevice, LimitsForceAndTorqueEachForItself) {
  SixAxes run("press:from_m=0,to_m=0", "none");
  Vector asked(6);
  asked << 4, 0, 0, 0, 0, 3;
  run.tick([&](const Reading& /*reading*/) { return asked; });
  EXPECT_LT((run.applied() - 0.1 * asked).norm(), 1e-12) << "a tenth of both: the torque may be 0.3 N m";
  asked << 80, 0, 0, 0, 0, 0.1;
  run.tick([&](const Reading& /*reading*/) { return asked; });
  EXPECT_LT((run.applied() - 0.1 * asked).norm(), 1e-12) << "the force may be 8 N";
}

TEST(ForceBoundingLaws, TakeADeviceThatTurns) {
  const control::DeviceFacts facts = load_device("arm-6dof").facts;
  for (const char* const law : {"none", "fba-less", "fba-more", "fba-exact"}) {
    EXPECT_EQ(control::force_bounding_laws().refusal(law, facts), "") << law;
  }
}

}  // namespace
}  // namespace forcebound::device
