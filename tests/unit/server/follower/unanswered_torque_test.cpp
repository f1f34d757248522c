#include "forcebound/server/follower/unanswered_torque.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "forcebound/server/follower/follower.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/driven_arm.hpp"
#include "tests/support/fake_clock.hpp"
#include "tests/support/gantry_robot.hpp"
#include "tests/tools/lab/teleoperation/robot_flaws.hpp"

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;
using control::FollowerState;
using lab::RobotFlaws;

constexpr Nanoseconds kFollows{1s};  // it has engaged
const char* const kFrozen = "no joint answers its torque: the readings are frozen";

/// A robot whose readings freeze, led at 1 kHz by a place as a function of time.
class LedRobot {
 public:
  using Lead = std::function<Eigen::Vector3d(double time_s)>;

  LedRobot(std::unique_ptr<Robot> at_work, const RobotFlaws& flaws, const std::string& architecture) : flaws_(flaws) {
    auto flawed = std::make_unique<lab::FlawedRobotOf<Robot>>(std::move(at_work), flaws);
    robot = flawed.get();
    FollowerSettings settings{.architecture = architecture};
    settings.workspace.rotation.setIdentity();
    follower = std::make_unique<Follower>(std::move(flawed), settings, control::force_bounding_laws(), clock);
    follower->start();
    leader.position = Vector::Zero(3);
  }

  void run(Nanoseconds duration, const Lead& lead) {
    for (const Nanoseconds begin = clock.time; clock.time < begin + duration; clock.time += 1ms) {
      follower->tick(clock.time);
      update(clock.time);
      leader.position = lead(time::to_seconds(clock.time - begin));
      leader.arrived = clock.time;
      leader.energy_given_J += 5e-3;
      follower->receive(leader);
    }
  }

  test::FakeClock clock{};
  lab::FlawedRobotOf<Robot>* robot = nullptr;
  std::unique_ptr<Follower> follower;
  LeaderMotion leader;
  double turned = 0;  ///< farthest, of a joint since its readings are frozen [rad]

 private:
  void update(Nanoseconds now) {
    if (now < flaws_.frozen_from) return;
    if (frozen_at_.rows() == 0) frozen_at_ = robot->truth();
    turned = std::max(turned, (robot->truth() - frozen_at_).cwiseAbs().maxCoeff());
  }

  RobotFlaws flaws_;
  Vector frozen_at_{};
};

LedRobot::Lead still() {
  return [](double) { return Eigen::Vector3d(Eigen::Vector3d::Zero()); };
}

/// Up and to the side, at that speed, for up to 0.2 m.
LedRobot::Lead away(double m_per_s) {
  return
      [=](double time_s) { return Eigen::Vector3d(std::min(m_per_s * time_s, 0.2) * Eigen::Vector3d(0, -0.5, 0.866)); };
}

std::unique_ptr<Robot> example_arm() { return open_robot(test::robot_driver("example")); }

/// Frozen so long after its leader began to move away, for as long as it moves.
LedRobot frozen_on_its_way(std::unique_ptr<Robot> robot, Nanoseconds after, double m_per_s,
                           const std::string& architecture = "position-position") {
  const RobotFlaws flaws{.frozen_from = kFollows + after, .frozen_until = 1h};
  LedRobot led(std::move(robot), flaws, architecture);
  led.run(kFollows, still());
  EXPECT_EQ(led.follower->report().state, FollowerState::following);
  led.run(6s, away(m_per_s));
  return led;
}

TEST(UnansweredTorque, TheExampleArmStopsOnceItsReadingsFreeze) {
  for (const Nanoseconds after : {0ms, 20ms, 100ms, 300ms, 600ms}) {
    for (const double m_per_s : {0.02, 0.05, 0.1, 0.2, 0.25}) {
      SCOPED_TRACE("after " + std::to_string(after / 1ms) + " ms at " + std::to_string(m_per_s) + " m/s");
      const LedRobot led = frozen_on_its_way(example_arm(), after, m_per_s);
      EXPECT_LT(led.turned, 0.8) << "rad; the slowest turns farthest";
      EXPECT_EQ(led.follower->totals().why_stopped, kFrozen);
    }
  }
}

TEST(UnansweredTorque, AnArmWithASensorAndBrakesIsStoppedToo) {
  for (const char* const architecture : {"position-position", "position-force"}) {
    for (const Nanoseconds after : {0ms, 100ms, 400ms}) {
      for (const double m_per_s : {0.02, 0.05, 0.2}) {
        SCOPED_TRACE(std::string(architecture) + " after " + std::to_string(after / 1ms) + " ms at " +
                     std::to_string(m_per_s) + " m/s");
        const LedRobot led = frozen_on_its_way(test::driven_arm(), after, m_per_s, architecture);
        EXPECT_LT(led.turned, 1.4) << "rad";
        EXPECT_EQ(led.follower->totals().why_stopped, kFrozen);
      }
    }
  }
}

TEST(UnansweredTorque, ARobotIsNeverSaidToBeFrozenForStandingStill) {
  for (const double wall_N_per_m : {500.0, 5000.0, 50000.0}) {
    for (const double step_m : {0.0, 1e-6, 1e-4, 1e-3}) {
      for (const bool has_sensor : {true, false}) {
        SCOPED_TRACE(std::to_string(wall_N_per_m) + " N/m, step " + std::to_string(step_m) +
                     (has_sensor ? ", sensor" : ""));
        const test::GantrySettings gantry{
            .encoder_step_m = step_m, .wall_m = 0.02, .wall_N_per_m = wall_N_per_m, .has_sensor = has_sensor};
        LedRobot led(std::make_unique<test::GantryRobot>(gantry), {}, "position-position");
        led.run(kFollows, still());
        led.run(4s, [](double time_s) { return Eigen::Vector3d(std::min(0.02 * time_s, 0.04), 0, 0); });
        EXPECT_EQ(led.follower->totals().stops, 0U) << led.follower->totals().why_stopped;
        EXPECT_GT(led.robot->truth()[0], 0.0195) << "it presses";
      }
    }
  }
}

TEST(UnansweredTorque, MuchMoreFrictionThanToldNeitherStopsNorHoldsARobot) {
  for (const double stiction_N : {1.0, 3.0, 5.5}) {
    for (const double m_per_s : {0.002, 0.01, 0.05}) {
      SCOPED_TRACE(std::to_string(stiction_N) + " N at " + std::to_string(m_per_s) + " m/s");
      test::GantrySettings gantry;
      gantry.wall_m = 1;
      gantry.stiction_N = stiction_N;
      LedRobot led(std::make_unique<test::GantryRobot>(gantry), {}, "position-position");
      led.run(kFollows, still());
      led.run(4s, [=](double time_s) { return Eigen::Vector3d(m_per_s * time_s, 0, 0); });
      EXPECT_EQ(led.follower->totals().stops, 0U);
      EXPECT_NEAR(led.robot->truth()[0], m_per_s * 4, 0.008);
    }
  }
}

TEST(UnansweredTorque, AFrozenRobotFollowsAgainOnceItsReadingsDo) {
  LedRobot led(example_arm(), {.frozen_from = kFollows + 100ms, .frozen_until = kFollows + 1s}, "position-position");
  led.run(kFollows, still());
  led.run(1s, away(0.1));
  EXPECT_EQ(led.follower->totals().why_stopped, kFrozen);
  EXPECT_EQ(led.follower->report().state, FollowerState::stopped);
  led.run(1s, still());
  EXPECT_EQ(led.follower->report().state, FollowerState::following);
  led.run(1s, away(0.02));
  EXPECT_EQ(led.follower->totals().stops, 1U);
}

TEST(UnansweredTorque, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const auto robot = test::driven_arm();
  UnansweredTorque unanswered(*robot);
  device::Reading reading = robot->read(1s);
  const test::AllocationGuard guard;
  for (int tick = 0; tick < 500; ++tick, reading.latched += 1ms) {
    if (tick < 3) reading.joint.array() += 1e-3;
    unanswered.update(reading, Vector::Constant(7, tick < 20 ? 0 : 20), Vector6::Zero());
  }
  EXPECT_TRUE(unanswered.frozen());
  unanswered.restart();
  EXPECT_FALSE(unanswered.frozen());
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::server
