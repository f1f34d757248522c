#include "forcebound/server/follower/robot_guard.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <string_view>
#include <thread>

#include "forcebound/time/clock.hpp"
#include "tests/support/becomes_true.hpp"
#include "tests/support/gantry_robot.hpp"

namespace forcebound::server {
namespace {

using namespace std::chrono_literals;
using Trouble = RobotGuard::Trouble;

/// That the test sets, and another thread reads.
class SharedClock final : public time::Clock {
 public:
  [[nodiscard]] Nanoseconds now() const noexcept override { return Nanoseconds{ns.load()}; }

  std::atomic<std::int64_t> ns{1'000'000'000};
};

/// Counts how often it is stopped.
class CountingRobot final : public test::GantryRobot {
 public:
  void stop(Nanoseconds /*now*/) noexcept override { ++stops; }

  [[nodiscard]] std::string_view crash() const noexcept override {
    return has_crashed ? "driver 'gantry' crashed in read" : "";
  }

  std::atomic<int> stops{0};
  std::atomic<bool> has_crashed{false};
};

class GuardedRobot : public testing::Test {
 protected:
  void wait_for_stops(int stops) const {
    ASSERT_TRUE(test::becomes_true([&] { return robot_.stops >= stops; }));
  }
  /// For which the next tick may be awaited.
  [[nodiscard]] Nanoseconds limit() const { return RobotGuard::kSlow + time::from_seconds(robot_.facts().period_s); }
  /// Long enough for the guard to have looked several times.
  static void give_time() { std::this_thread::sleep_for(50ms); }
  void pass(Nanoseconds time) { clock_.ns += time.count(); }

  SharedClock clock_;
  CountingRobot robot_;
  RobotGuard guard_{robot_, clock_, std::nullopt};
};

TEST_F(GuardedRobot, IsLeftAloneBeforeTheFirstTickAndAfterTheLastAndWhereTheNextIsInTime) {
  pass(1h);
  give_time();
  EXPECT_EQ(guard_.trouble(), Trouble::none);
  guard_.store_tick_time(clock_.now());
  pass(limit());
  give_time();
  EXPECT_EQ(guard_.trouble(), Trouble::none);
  guard_.end();
  pass(1h);
  give_time();
  EXPECT_EQ(guard_.trouble(), Trouble::none);
  EXPECT_EQ(robot_.stops, 0);
}

TEST_F(GuardedRobot, IsStoppedOnceWhereTheNextTickIsLate) {
  guard_.store_tick_time(clock_.now());
  pass(limit() + 1ns);
  EXPECT_EQ(guard_.trouble(), Trouble::slow);
  wait_for_stops(1);
  pass(100ms);
  give_time();
  EXPECT_EQ(robot_.stops, 1);
  EXPECT_FALSE(guard_.is_lost());
  guard_.store_tick_time(clock_.now());
  EXPECT_EQ(guard_.trouble(), Trouble::none);
  pass(limit() + 1ns);
  wait_for_stops(2);
  guard_.end();
}

TEST_F(GuardedRobot, IsLostWhereNoTickFollows) {
  guard_.store_tick_time(clock_.now());
  pass(RobotGuard::kStuck + 1ns);
  EXPECT_EQ(guard_.trouble(), Trouble::stuck);
  EXPECT_TRUE(guard_.is_lost());
  wait_for_stops(1);
  EXPECT_TRUE(test::becomes_true([&] { return guard_.stopped(); }));
  EXPECT_TRUE(guard_.crash().empty());
}

TEST_F(GuardedRobot, WhoseDriverHasCrashedIsLost) {
  guard_.store_tick_time(clock_.now());
  EXPECT_FALSE(guard_.is_lost());
  robot_.has_crashed = true;
  EXPECT_TRUE(guard_.is_lost());
  EXPECT_EQ(guard_.trouble(), Trouble::crashed);
  EXPECT_EQ(guard_.crash(), "driver 'gantry' crashed in read");
}

}  // namespace
}  // namespace forcebound::server
