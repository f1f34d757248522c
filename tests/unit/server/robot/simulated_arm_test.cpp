#include "forcebound/server/robot/simulated_arm.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "forcebound/control/exact_law.hpp"
#include "forcebound/control/transparent_law.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/unit/server/robot/scripted_run.hpp"

namespace forcebound::server {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

/// Runs the arm under one torque, commanded every millisecond.
void hold(SimulatedArm& arm, const Vector& torque, milliseconds from, milliseconds until) {
  for (milliseconds now = from; now < until; ++now) {
    (void)arm.read(now);
    arm.apply(now, torque);
  }
  (void)arm.read(until);
}

Vector one_joint(Eigen::Index joint, double torque) {
  Vector all = Vector::Zero(7);
  all[joint] = torque;
  return all;
}

TEST(SimulatedArm, ReadsItsEncodersInWholeSteps) {
  SimulatedArm arm(free_task(), 1);
  hold(arm, one_joint(0, 3), milliseconds(0), milliseconds(200));
  const device::Reading reading = arm.read(milliseconds(200));
  ASSERT_TRUE(device::is_usable(reading, 7));
  for (Eigen::Index i = 0; i < 7; ++i) {
    const double steps = reading.joint[i] / arm.facts().encoder_step[i];
    EXPECT_NEAR(steps, std::round(steps), 1e-6);
    EXPECT_LE(std::abs(reading.joint[i] - arm.truth().joint[i]), 0.5001 * arm.facts().encoder_step[i]);
  }
}

TEST(SimulatedArm, TellsItsFactsWithUnitsOfJoints) {
  EXPECT_EQ(
      SimulatedArm(free_task(), 1).facts_in_words(),
      "reach-7: simulated arm of 7 joints, damping 0.8 to 4 N m s/rad, friction 0.2 to 0.8 N m, encoder step 5.99 "
      "to 24 urad, largest torque 12 to 87 N m, latency 0.3 ms, holds a torque for 2 ms");
}

TEST(SimulatedArm, DoesNotCreepInAMinuteUnderTorquesThatFrictionHolds) {
  SimulatedArm arm(free_task(), 1);
  const Vector start = arm.truth().joint;
  hold(arm, 0.5 * arm.facts().friction, milliseconds(0), std::chrono::minutes(1));
  EXPECT_EQ(arm.truth().joint, start);
  EXPECT_EQ(arm.audit()->minimum_J, 0);
}

TEST(SimulatedArm, NeedsNoTorqueAgainstGravity) {
  SimulatedArm arm(free_task(), 1);
  const Vector start = arm.truth().joint;
  (void)arm.read(milliseconds(0));
  (void)arm.read(milliseconds(5000));
  EXPECT_EQ(arm.truth().joint, start);
}

TEST(SimulatedArm, TurnsAtTheSpeedAtWhichDampingAndFrictionTakeTheTorque) {
  SimulatedArm arm(free_task(), 1);
  // The last joint turns about the tool's own axis, so that no other one moves with it but by friction.
  hold(arm, one_joint(6, 0.6), milliseconds(0), milliseconds(1500));
  EXPECT_NEAR(arm.truth().joint_velocity[6], (0.6 - 0.2) / 0.8, 1e-3);
}

TEST(SimulatedArm, ItsMotionHasTheEnergyThatTheMotorsGaveBeyondWhatJointsTook) {
  SimulatedArm arm(free_task(), 1);
  Vector torque = 2 * arm.facts().friction;
  torque[1] += 8;
  hold(arm, torque, milliseconds(0), milliseconds(400));
  const double kinetic_J = arm.truth().kinetic_J;
  EXPECT_GT(kinetic_J, 1);
  EXPECT_NEAR(arm.audit()->energy_J, -kinetic_J, 0.01 * kinetic_J)
      << "but for the error of steps of half a millisecond";
}

TEST(SimulatedArm, ReleasesATorqueAfterTheHoldTime) {
  SimulatedArm arm(free_task(), 1);
  (void)arm.read(milliseconds(0));
  arm.apply(milliseconds(0), one_joint(0, 20));
  EXPECT_FALSE(arm.released_at().has_value());
  (void)arm.read(milliseconds(2));
  EXPECT_FALSE(arm.released_at().has_value());
  (void)arm.read(milliseconds(3));
  EXPECT_EQ(arm.released_at(), microseconds(2300));
  const double fastest = arm.truth().joint_velocity[0];
  EXPECT_GT(fastest, 0.01);
  (void)arm.read(milliseconds(500));
  EXPECT_EQ(arm.truth().joint_velocity[0], 0) << "friction has stopped it";
}

TEST(SimulatedArm, ShortensTorquesBeyondItsLimitsAllAlike) {
  SimulatedArm strong(free_task(), 1);
  SimulatedArm limited(free_task(), 1);
  Vector torque = 0.5 * strong.model().limits().torque_max;
  hold(strong, torque, milliseconds(0), milliseconds(30));
  torque = strong.model().limits().torque_max;
  torque *= 0.5;
  hold(limited, torque, milliseconds(0), milliseconds(30));
  EXPECT_EQ(strong.truth().joint, limited.truth().joint);
  SimulatedArm asked_for_too_much(free_task(), 1);
  SimulatedArm at_its_limit(free_task(), 1);
  hold(asked_for_too_much, one_joint(4, 1000), milliseconds(0), milliseconds(30));
  hold(at_its_limit, one_joint(4, 12), milliseconds(0), milliseconds(30));
  EXPECT_EQ(asked_for_too_much.truth().joint, at_its_limit.truth().joint);
}

TEST(SimulatedArm, TakesFaultyCommandsForZeroTorqueAndCountsThem) {
  SimulatedArm arm(free_task(), 1);
  const Vector start = arm.truth().joint;
  hold(arm, Vector::Constant(7, std::numeric_limits<double>::quiet_NaN()), milliseconds(0), milliseconds(10));
  hold(arm, Vector::Constant(6, 50), milliseconds(10), milliseconds(20));
  EXPECT_EQ(arm.truth().joint, start);
  EXPECT_EQ(arm.counters().faulty_commands, 20U);
}

TEST(SimulatedArm, IsTheSameForTheSameCalls) {
  const auto end = [](std::uint64_t seed) {
    SimulatedArm arm(free_task(), seed);
    hold(arm, Vector::Constant(7, 2), milliseconds(0), milliseconds(300));
    return std::pair(arm.truth().joint, arm.sensed_force()->force_N);
  };
  EXPECT_EQ(end(1), end(1));
  EXPECT_EQ(end(1).first, end(2).first);
  EXPECT_NE(end(1).second, end(2).second);
}

TEST(SimulatedArm, StopsAtItsEndStops) {
  SimulatedArm arm(free_task(), 1);
  hold(arm, one_joint(6, 5), milliseconds(0), milliseconds(4000));
  EXPECT_NEAR(arm.truth().joint[6], arm.model().limits().highest[6], 0.01);
  EXPECT_LT(std::abs(arm.truth().joint_velocity[6]), 1e-3);
}

TEST(SimulatedArm, ComesToRestSoonAfterASoftStopAndStays) {
  SimulatedArm arm(free_task(), 1);
  hold(arm, one_joint(0, 30), milliseconds(0), milliseconds(250));
  EXPECT_GT(arm.truth().tool.velocity.norm(), 0.5);
  arm.soft_stop(milliseconds(250));
  EXPECT_TRUE(arm.is_stopped());
  EXPECT_TRUE(arm.write_failed()) << "nobody shall count on the command before it";
  const Eigen::Vector3d there = arm.truth().tool.position;
  milliseconds now(250);
  while (arm.truth().joint_velocity.norm() > 0 && now < milliseconds(2000)) (void)arm.read(++now);
  EXPECT_LT(now, milliseconds(500));
  EXPECT_LT((arm.truth().tool.position - there).norm(), 0.1);
  const Vector rest = arm.truth().joint;
  hold(arm, Vector::Constant(7, 10), now, now + milliseconds(200));
  EXPECT_EQ(arm.truth().joint, rest) << "commands are ignored";
  EXPECT_TRUE(arm.write_failed());
  now += milliseconds(200);
  arm.resume(now);
  (void)arm.read(now + milliseconds(100));
  EXPECT_EQ(arm.truth().joint, rest) << "nothing is commanded";
  hold(arm, one_joint(0, 30), now + milliseconds(100), now + milliseconds(300));
  EXPECT_FALSE(arm.write_failed());
  EXPECT_GT((arm.truth().joint - rest).norm(), 0.1);
}

TEST(SimulatedArm, HeldByABrakeGivesWayToAPersonWhoPushesHard) {
  SimulatedArm arm(free_task(), 1);
  arm.soft_stop(milliseconds(0));
  Vector6 push = Vector6::Zero();
  const auto moved_by = [&](double force_N, milliseconds from) {
    const Eigen::Vector3d before = arm.truth().tool.position;
    push.y() = force_N;
    arm.push(from, push);
    (void)arm.read(from + milliseconds(500));
    return (arm.truth().tool.position - before).norm();
  };
  EXPECT_EQ(moved_by(10, milliseconds(0)), 0);
  EXPECT_GT(moved_by(100, milliseconds(500)), 0.005);
}

TEST(SimulatedArm, MovesItsGripper) {
  SimulatedArm arm(free_task(), 1);
  (void)arm.read(milliseconds(0));
  EXPECT_NEAR(*arm.gripper(), 0, 1e-6);
  arm.command_gripper(milliseconds(0), 0.5);
  const device::Reading reading = arm.read(milliseconds(1000));
  EXPECT_NEAR(*reading.handle.gripper, 0.5, 1e-3);
  arm.command_gripper(milliseconds(1000), std::numeric_limits<double>::quiet_NaN());
  arm.command_gripper(milliseconds(1000), 7);
  (void)arm.read(milliseconds(3000));
  EXPECT_NEAR(*arm.gripper(), 1, 1e-3);
}

TEST(SimulatedArm, SensorFeelsWhoPushesTheTool) {
  SimulatedArm arm(free_task(), 1);
  (void)arm.read(milliseconds(0));
  Vector6 push = Vector6::Zero();
  push.x() = -7;
  arm.push(milliseconds(0), push);
  (void)arm.read(milliseconds(100));
  EXPECT_EQ(arm.sensed_force()->sampled, milliseconds(100));
  EXPECT_NEAR(arm.sensed_force()->force_N.x(), 7, 0.5 + 5 * 0.15) << "it is what the tool exerts on its surroundings";
  EXPECT_FALSE(arm.progress().in_contact);
}

TEST(SimulatedArm, SimulatesAGapOfTenSecondsAtMost) {
  SimulatedArm arm(free_task(), 1);
  (void)arm.read(milliseconds(0));
  (void)arm.read(std::chrono::hours(1));
  EXPECT_EQ(arm.counters().gaps_cut, 1U);
  hold(arm, one_joint(0, 5), std::chrono::hours(1), std::chrono::hours(1) + milliseconds(100));
  EXPECT_GT(arm.truth().joint_velocity[0], 0.1);
}

TEST(SimulatedArm, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  SimulatedArm arm(load_task("block"), 1);
  const test::AllocationGuard guard;
  for (milliseconds now(0); now < milliseconds(200); ++now) {
    (void)arm.read(now);
    arm.apply(now, Vector::Constant(7, 3));
  }
  arm.command_gripper(milliseconds(200), 1);
  arm.soft_stop(milliseconds(200));
  arm.resume(milliseconds(210));
  (void)arm.progress();
  (void)arm.sensed_force();
  (void)arm.audit();
  EXPECT_EQ(guard.heap_operations(), 0U);
}

/// Somebody pushes the tool about, and whoever commands the motors wants as much energy as he can get.
class Opponent {
 public:
  explicit Opponent(std::uint64_t seed) : random_(seed) {}

  Nanoseconds next_tick(Nanoseconds now) {
    // Mostly at 1 kHz, sometimes so late that the torque is released.
    const double passed_s = number(0, 1) < 0.05 ? number(2e-3, 6e-3) : number(0.7e-3, 1.3e-3);
    return now + time::from_seconds(passed_s);
  }

  Vector6 push() {
    if (number(0, 1) < 0.03) {
      for (double& axis : push_.head<3>()) axis = number(-60, 60);
      for (double& axis : push_.tail<3>()) axis = number(-8, 8);
    }
    return push_;
  }

  /// Somebody presses the robot's stop, or opens it again.
  void stop_or_resume(SimulatedArm& arm, Nanoseconds now) {
    if (number(0, 1) > (arm.is_stopped() ? 0.05 : 0.005)) return;
    arm.is_stopped() ? arm.resume(now) : arm.soft_stop(now);
  }

  /// Along the motion, as far as can be known; or what held joints need to begin; or anything.
  Vector torque(const SimulatedArm& arm) {
    if (number(0, 1) < 0.02) mood_ = number(0, 1);
    const Vector& most = arm.model().limits().torque_max;
    Vector torque = Vector::Zero(7);
    for (Eigen::Index i = 0; i < 7; ++i) {
      const double speed = arm.truth().joint_velocity[i];
      torque[i] = mood_ < 0.6 ? (speed > 0 ? most[i] : speed < 0 ? -most[i] : 0) : number(-most[i], most[i]);
    }
    return mood_ > 0.9 ? Vector(0.01 * torque) : torque;
  }

 private:
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

  std::mt19937_64 random_;
  Vector6 push_{Vector6::Zero()};
  double mood_ = 0;
};

template <class Law>
double least_of_game(std::uint64_t seed, const std::string& task, const Law& law, bool stops = false) {
  SimulatedArm arm(task.empty() ? free_task() : load_task(task), seed);
  LawfulTick loop(arm, law(arm.facts()));
  Opponent opponent(seed);
  for (Nanoseconds now{0}; now < milliseconds(1500); now = opponent.next_tick(now)) {
    const device::Reading reading = arm.read(now);
    arm.push(now, opponent.push());
    (void)loop.tick(now, reading, opponent.torque(arm));
    if (stops) opponent.stop_or_resume(arm, now + microseconds(200));
  }
  EXPECT_EQ(arm.counters().frozen_joints, 0U);
  return arm.audit()->minimum_J;
}

TEST(SimulatedArm, IsPassiveUnderTheExactLawWhoeverPushesAndCommands) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {  // twice each memory with each task
    SCOPED_TRACE(seed);
    const auto law = [&](const control::DeviceFacts& facts) {
      const auto memory = seed % 2 == 0 ? control::EnergyMemory::full : control::EnergyMemory::capped;
      return std::make_unique<control::ExactLaw>(facts, memory);
    };
    // In free space, and with whatever the tool hits.
    EXPECT_GE(least_of_game(seed, seed % 3 == 0 ? "block" : seed % 3 == 1 ? "" : "edge", law), -1e-9);
    EXPECT_GE(least_of_game(seed, "", law, true), -1e-9) << "with stops";
  }
}

TEST(SimulatedArm, IsNotPassiveWithoutALaw) {
  const auto none = [](const control::DeviceFacts& facts) {
    return std::make_unique<control::TransparentLaw>(facts.joints(), facts.period_s);
  };
  EXPECT_LT(least_of_game(1, "", none), -1) << "the opponent is too weak to prove anything";
}

}  // namespace
}  // namespace forcebound::server
