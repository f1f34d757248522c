#include "forcebound/server/follower/follower_thread.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "forcebound/time/steady_clock.hpp"
#include "tests/support/becomes_true.hpp"
#include "tests/support/gantry_robot.hpp"

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;
using enum control::FollowerState;

/// A gantry that is said to be real, and whose readings take long while they are told to.
class SlowGantry final : public test::GantryRobot {
 public:
  SlowGantry(std::atomic<bool>& slow, std::atomic<int>& stops) : slow_(slow), stops_(stops) {}
  [[nodiscard]] bool is_simulated() const noexcept override { return false; }
  device::Reading read(Nanoseconds now) noexcept override {
    slow_.wait(true);
    return GantryRobot::read(now);
  }
  void stop(Nanoseconds /*now*/) noexcept override {
    // Not for a machine that gave the loop no time before.
    if (slow_) ++stops_;
  }
  void apply(Nanoseconds now, const Vector& force_N) noexcept override {
    // As a real one: stopped from outside, whoever asked for it.
    if (stops_ > 0 && !is_stopped()) soft_stop(now);
    GantryRobot::apply(now, force_N);
  }

 private:
  std::atomic<bool>& slow_;
  std::atomic<int>& stops_;
};

/// A gantry on a thread of its own, and its leader on that of the test.
class Led {
 public:
  explicit Led(const EngagementTimes& times = {}) : Led(std::make_unique<test::GantryRobot>(), times) {}
  explicit Led(std::unique_ptr<Robot> robot, const EngagementTimes& times = {}) {
    FollowerSettings settings{.architecture = "position-position", .times = times};
    settings.workspace.rotation.setIdentity();
    thread = std::make_unique<FollowerThread>(
        std::make_unique<Follower>(std::move(robot), settings, control::force_bounding_laws(), clock), clock);
    motion.position = Vector::Zero(3);
  }

  /// The leader is still until the robot is in this state.
  void lead_until(FollowerState state) {
    ASSERT_TRUE(test::becomes_true([&] {
      exchange(0);
      return thread->newest().state == state;
    }));
  }
  /// It moves, as somebody does who takes it into the hand.
  void move() {
    for (int n = 0; n < 100; ++n) {
      exchange(1e-4);
      std::this_thread::sleep_for(1ms);
    }
  }
  void wait_until(FollowerState state) {
    ASSERT_TRUE(test::becomes_true([&] { return thread->newest().state == state; }));
  }

  void exchange(double step_m) {
    motion.position[1] += step_m;
    motion.energy_given_J += 2e-3;
    motion.arrived = clock.now();
    (void)thread->exchange(motion);
  }

  [[nodiscard]] std::vector<FollowerState> states() {
    std::vector<FollowerState> all;
    while (const auto change = thread->take_change()) {
      EXPECT_TRUE(all.empty() || all.back() == change->from) << "no change is missing";
      all.push_back(change->to);
    }
    return all;
  }

  time::SteadyClock clock;
  std::unique_ptr<FollowerThread> thread;
  LeaderMotion motion;
};

TEST(FollowerThread, HoldsWhileItsLeaderIsSilentAndGoesOnWhenItIsHeard) {
  // So late a stop that no machine is slow enough for it.
  Led led({.stop = 1h});
  led.thread->begin_leader();
  led.lead_until(following);
  led.wait_until(holding);
  EXPECT_FALSE(led.thread->newest().leader_lost);
  led.lead_until(following);
  const FollowerThread::Outcome& outcome = led.thread->stop();
  EXPECT_TRUE(outcome.at_rest) << "the end stops what moves";
  EXPECT_EQ(outcome.changes_lost, 0U);
  EXPECT_GE(outcome.totals.port.minimum_J, -1e-9);
  const auto states = led.states();
  ASSERT_GE(states.size(), 5U);
  EXPECT_EQ(states[0], following);
  EXPECT_EQ(states[1], holding);
  EXPECT_EQ(states[2], following);
  EXPECT_EQ(states[states.size() - 2], stopping);
  EXPECT_EQ(states.back(), stopped);
}

TEST(FollowerThread, StopsWhenItsLeaderIsSilentForLonger) {
  Led led;
  led.thread->begin_leader();
  led.lead_until(following);
  led.wait_until(stopped);
  EXPECT_TRUE(led.thread->newest().leader_lost);
  const FollowerThread::Outcome& outcome = led.thread->stop();
  EXPECT_EQ(outcome.totals.why_stopped, "the leader is silent");
  EXPECT_TRUE(outcome.at_rest);
  const auto states = led.states();
  ASSERT_GE(states.size(), 3U);
  EXPECT_EQ(states[states.size() - 2], stopping);
  EXPECT_EQ(states.back(), stopped);
}

TEST(FollowerThread, ChangesTellTimesThatAgreeWithTheStates) {
  const EngagementTimes times;
  Led led(times);
  led.thread->begin_leader();
  led.lead_until(following);
  led.wait_until(stopped);
  (void)led.thread->stop();
  while (const auto change = led.thread->take_change()) {
    if (change->to == holding) {
      ASSERT_TRUE(change->silent);
      EXPECT_GT(*change->silent, times.hold);
    }
    if (change->to == stopping) {
      ASSERT_TRUE(change->silent);
      EXPECT_GT(*change->silent, times.stop);
      EXPECT_EQ(change->why_stopped, "the leader is silent");
    }
  }
}

TEST(FollowerThread, ALeaderWhoLeavesStopsTheRobotAtOnce) {
  Led led;
  led.thread->begin_leader();
  led.lead_until(following);
  led.thread->leave();
  led.wait_until(stopped);
  EXPECT_FALSE(led.thread->newest().leader_lost);
  EXPECT_EQ(led.thread->stop().totals.why_stopped, "the leader has left");
}

TEST(FollowerThread, TheNextLeaderEngagesAnew) {
  Led led;
  led.thread->begin_leader();
  led.lead_until(following);
  led.thread->leave();
  led.thread->begin_leader();
  // Another device, elsewhere, with a smaller sum of energy.
  led.motion = {.position = Vector::Constant(3, 0.1)};
  led.wait_until(stopped);
  led.move();
  led.lead_until(following);
  const FollowerThread::Outcome& outcome = led.thread->stop();
  EXPECT_TRUE(outcome.at_rest);
  EXPECT_GE(outcome.totals.port.minimum_J, -1e-9);
}

TEST(FollowerThread, CountsItsTimeInStatesAndItsWakeUps) {
  Led led;
  led.thread->begin_leader();
  led.lead_until(following);
  const FollowerThread::Outcome& outcome = led.thread->stop();
  EXPECT_GT(outcome.in_state[waiting], 0ns);
  EXPECT_GT(outcome.in_state[following], 0ns);
  EXPECT_EQ(outcome.loop.wake_ups, outcome.totals.ticks - 1) << "an interval between two ticks each";
  EXPECT_GT(outcome.idle.wake_ups, 0U);
  EXPECT_EQ(outcome.allocations, 0U);
}

TEST(FollowerThread, TellsItsLeaderThatTheRobotHasFailedWhileItsDriverDoesNotReturn) {
  std::atomic<bool> slow{false};
  std::atomic<int> stops{0};
  Led led(std::make_unique<SlowGantry>(slow, stops));
  led.thread->begin_leader();
  led.lead_until(following);
  slow = true;
  led.lead_until(failed);
  EXPECT_EQ(led.thread->newest().share, 0) << "no force on the hand";
  EXPECT_TRUE(test::becomes_true([&] { return stops > 0; }));
  slow = false;
  slow.notify_all();
  led.lead_until(stopped);
  EXPECT_EQ(led.thread->trouble(), RobotGuard::Trouble::none);
  EXPECT_FALSE(led.thread->is_lost());
  EXPECT_TRUE(led.thread->stop().at_rest);
}

TEST(FollowerThread, EndsWithoutALeaderToo) {
  Led led;
  led.wait_until(waiting);
  EXPECT_TRUE(led.thread->stop().at_rest);
  EXPECT_EQ(&led.thread->stop(), &led.thread->stop()) << "once";
  EXPECT_TRUE(led.states().empty());
}

}  // namespace
}  // namespace forcebound::server
