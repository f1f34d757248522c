#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "forcebound/server/follower/follower.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/driven_arm.hpp"
#include "tests/support/fake_clock.hpp"

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;
using control::FollowerState;

/// The simulated arm behind its driver, which a hand leads at 1 kHz.
class DrivenFollower {
 public:
  using Lead = std::function<void(double time_s, LeaderMotion& leader)>;

  explicit DrivenFollower(const std::string& settings = {}, const std::string& architecture = "position-force") {
    auto made = test::driven_arm(settings);
    robot = made.get();
    follower = std::make_unique<Follower>(std::move(made), FollowerSettings{.architecture = architecture},
                                          control::force_bounding_laws(), clock);
    follower->start();
    leader.position = Vector::Zero(3);
  }

  void run(Nanoseconds duration, const Lead& lead) {
    for (const Nanoseconds begin = now; now < begin + duration; now += 1ms) {
      clock.time = now;
      follower->tick(now);
      lead(time::to_seconds(now - begin), leader);
      leader.arrived = now;
      leader.energy_given_J += 2e-3;
      follower->receive(leader);
    }
  }
  void engage() {
    run(1s, [](double, LeaderMotion&) {});
    ASSERT_EQ(follower->report().state, FollowerState::following);
  }
  [[nodiscard]] double tool_height_m() const { return follower->report().picture.tool.position.z(); }

  test::FakeClock clock;
  DriverRobot* robot = nullptr;
  std::unique_ptr<Follower> follower;
  LeaderMotion leader;
  Nanoseconds now{1s};
};

void press_down(double time_s, LeaderMotion& leader) { leader.position[2] = -0.05 * std::min(time_s, 1.0); }

TEST(DrivenRobot, FollowsTouchesAndStaysPassive) {
  DrivenFollower arm;
  arm.engage();
  const double start_m = arm.tool_height_m();
  arm.run(3s, press_down);
  EXPECT_LT(arm.tool_height_m(), start_m - 0.04) << "it touches the floor";
  const FollowerReport& report = arm.follower->report();
  EXPECT_GT(report.map.to_leader_N(report.reflection.at(Eigen::Vector3d::Zero()))[2], 2) << "which pushes back";
  const FollowerTotals totals = arm.follower->totals();
  EXPECT_TRUE(totals.audited);
  EXPECT_GE(totals.port.minimum_J, -1e-12);
  EXPECT_EQ(totals.stops, 0U);
}

TEST(DrivenRobot, StaysPassiveWheneverItIsStopped) {
  for (int ms = 50; ms <= 1600; ms += 110) {
    DrivenFollower arm;
    arm.engage();
    arm.run(ms * 1ms, [](double time_s, LeaderMotion& leader) {
      leader.position[2] = -0.05 * std::min(3 * time_s, 1.0) + 0.02 * std::sin(20 * time_s);
    });
    arm.follower->leave();
    for (int tick = 0; tick < 1000; ++tick, arm.now += 1ms) {
      arm.clock.time = arm.now;
      arm.follower->tick(arm.now);
    }
    EXPECT_EQ(arm.follower->report().state, FollowerState::stopped);
    EXPECT_GE(arm.follower->totals().port.minimum_J, -1e-12) << "stopped after " << ms << " ms";
  }
}

TEST(DrivenRobot, ThatStoppedByItselfBeforeAnybodyEngagedFollowsWhoKeepsStill) {
  DrivenFollower arm("fault=stops");
  arm.run(150ms, [](double, LeaderMotion&) {});
  EXPECT_EQ(arm.follower->report().state, FollowerState::waiting);
  EXPECT_TRUE(arm.robot->is_stopped());
  arm.engage();
  EXPECT_FALSE(arm.robot->is_stopped());
  EXPECT_GE(arm.follower->totals().port.minimum_J, -1e-12);
}

TEST(DrivenRobot, StaysPassiveWhenItStopsByItselfWhileItMoves) {
  for (int reading = 1200; reading <= 2400; reading += 100) {
    DrivenFollower arm("fault=stops,from=" + std::to_string(reading));
    arm.engage();
    arm.run(2s, [](double time_s, LeaderMotion& leader) {
      leader.position[2] = -0.05 * std::min(3 * time_s, 1.0) + 0.02 * std::sin(20 * time_s);
    });
    EXPECT_EQ(arm.follower->totals().stops, 1U);
    EXPECT_EQ(arm.follower->totals().why_stopped, "the robot stopped by itself") << reading;
    EXPECT_EQ(arm.follower->report().state, FollowerState::stopped) << reading;
    EXPECT_GE(arm.follower->totals().port.minimum_J, -1e-12) << "stopped in reading " << reading;
  }
}

TEST(DrivenRobot, OfWhichReadingsAreStaleGoesOnWithTheTorquesOfTheTickBefore) {
  const auto lag_m = [](const std::string& settings) {
    DrivenFollower arm(settings);
    arm.engage();
    arm.run(1s, [](double time_s, LeaderMotion& leader) { leader.position[2] = 0.02 * std::sin(6 * time_s); });
    EXPECT_EQ(refused(arm.follower->totals().readings), 0U);
    EXPECT_GE(arm.follower->totals().port.minimum_J, -1e-12);
    return arm.follower->totals().lag_m_max;
  };
  EXPECT_LT(lag_m("rate=200,fault=stale,from=1300"), 1.2 * lag_m("rate=200"));
}

TEST(DrivenRobot, GetsNoEnergyFromAJumpOfAnEncoder) {
  DrivenFollower arm("fault=jump");
  const auto without_energy = [](double, LeaderMotion& leader) { leader.energy_given_J = -2e-3; };
  arm.run(300ms, without_energy);
  EXPECT_LT(arm.follower->law().energy_J(), arm.follower->totals().initial_J + 1e-3)
      << "not damping * (1 rad)^2 / 1 ms";
}

TEST(DrivenRobot, IsStoppedWhenTheSensorThatItNeedsTellsNothingNew) {
  DrivenFollower arm("fault=frozen,from=1500");
  arm.engage();
  arm.run(550ms, [](double, LeaderMotion&) {});
  EXPECT_EQ(arm.follower->report().state, FollowerState::following);
  arm.run(20ms, [](double, LeaderMotion&) {});
  EXPECT_EQ(arm.follower->report().state, FollowerState::failed);
  EXPECT_TRUE(arm.robot->is_stopped());
  EXPECT_EQ(arm.robot->last_error(), "its force sensor tells nothing new");

  DrivenFollower without("fault=frozen,from=1500", "position-position");
  without.engage();
  without.run(570ms, [](double, LeaderMotion&) {});
  EXPECT_EQ(without.follower->report().state, FollowerState::following);
}

TEST(DrivenRobot, ThatLeavesItsWeightToTheProgramIsHeldUntilItsBrakesDo) {
  for (const char* const fault : {"nan", "far", "backwards", "future", "fails", "unplugged", "stops"}) {
    DrivenFollower arm(std::string("gravity=1,from=1500,fault=") + fault);
    arm.engage();
    const double height_m = arm.tool_height_m();
    arm.run(700ms, [](double, LeaderMotion&) {});
    EXPECT_TRUE(arm.robot->is_stopped()) << fault;
    // What is unplugged gets no command that would hold it until it is stopped.
    if (std::string(fault) == "unplugged") continue;
    EXPECT_NEAR(arm.tool_height_m(), height_m, 1e-3) << fault;
    // Somebody moves the device, keeps it still, and the robot follows again.
    arm.run(300ms, [](double time_s, LeaderMotion& leader) { leader.position[1] = 0.1 * time_s; });
    arm.engage();
    EXPECT_NEAR(arm.tool_height_m(), height_m, 1e-3) << fault << ", while its brakes opened";
  }
}

TEST(DrivenRobot, FailsAfterFiftyBadReadingsAndComesBackStopped) {
  for (const char* const fault : {"nan", "far", "backwards", "future", "fails", "unplugged"}) {
    DrivenFollower arm(std::string("fault=") + fault);
    const auto still = [](double, LeaderMotion&) {};
    arm.run(149ms, still);
    EXPECT_NE(arm.follower->report().state, FollowerState::failed) << fault;
    arm.run(3ms, still);
    EXPECT_EQ(arm.follower->report().state, FollowerState::failed) << fault;
    EXPECT_TRUE(arm.robot->is_stopped()) << fault;
    arm.run(100ms, still);
    EXPECT_EQ(arm.follower->report().state, FollowerState::stopped) << fault;
    EXPECT_GE(arm.follower->totals().port.minimum_J, -1e-12) << fault;
  }
}

TEST(DrivenRobot, WhoseCommandsFailFailsToo) {
  DrivenFollower arm("fault=write");
  const auto still = [](double, LeaderMotion&) {};
  arm.run(151ms, still);
  EXPECT_EQ(arm.follower->report().state, FollowerState::failed);
  EXPECT_EQ(arm.follower->totals().why_stopped, "the robot refuses");
}

TEST(DrivenRobot, WithoutASensorNeedsAnArchitectureWithoutOne) {
  EXPECT_THAT([] { const DrivenFollower arm("sensor=0"); },
              testing::ThrowsMessage<std::invalid_argument>(
                  "architecture 'position-force' needs a force sensor, and robot 'arm 7' has none: position-position "
                  "needs none"));
  DrivenFollower arm("sensor=0", "position-position");
  arm.engage();
  arm.run(3s, press_down);
  EXPECT_GE(arm.follower->totals().port.minimum_J, -1e-12);
}

TEST(DrivenRobot, ThatLeavesItsWeightToTheProgramIsHeldAndFollows) {
  DrivenFollower arm("gravity=1");
  arm.engage();
  const double start_m = arm.tool_height_m();
  arm.run(1s, [](double, LeaderMotion&) {});
  EXPECT_NEAR(arm.tool_height_m(), start_m, 1e-4);
  arm.run(2s, [](double time_s, LeaderMotion& leader) { leader.position[2] = 0.03 * std::min(time_s, 1.0); });
  EXPECT_NEAR(arm.tool_height_m(), start_m + 0.03, 3e-3);
}

TEST(DrivenRobot, DoesNotAllocateInATick) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  DrivenFollower arm("rate=4000");
  arm.run(1s, [](double, LeaderMotion&) {});
  const DrivenFollower::Lead lead = press_down;
  const test::AllocationGuard guard;
  arm.run(500ms, lead);
  arm.follower->leave();
  arm.follower->tick(arm.now);
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::server
