#include "forcebound/server/runtime/robot_guard.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "forcebound/time/clock.hpp"
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

  std::atomic<int> stops{0};
};

class GuardedRobot : public testing::Test {
 protected:
  void wait_for_stops(int stops) const {
    while (robot_.stops < stops) std::this_thread::sleep_for(1ms);
  }
  /// Long enough for the guard to have looked several times.
  static void give_time() { std::this_thread::sleep_for(50ms); }
  void pass(Nanoseconds time) { clock_.ns += time.count(); }

  SharedClock clock_;
  CountingRobot robot_;
  RobotGuard guard_{robot_, clock_, std::nullopt};
};

TEST_F(GuardedRobot, IsLeftAloneBetweenTicksAndInThoseThatTakeLessThanTheLimit) {
  pass(1h);
  give_time();
  EXPECT_EQ(guard_.trouble(), Trouble::none);
  guard_.begin(clock_.now());
  pass(RobotGuard::kSlow);
  give_time();
  EXPECT_EQ(guard_.trouble(), Trouble::none);
  EXPECT_EQ(robot_.stops, 0);
}

TEST_F(GuardedRobot, IsStoppedOnceInATickThatTakesLonger) {
  guard_.begin(clock_.now());
  pass(RobotGuard::kSlow + 1ns);
  EXPECT_EQ(guard_.trouble(), Trouble::slow);
  wait_for_stops(1);
  pass(100ms);
  give_time();
  EXPECT_EQ(robot_.stops, 1);
  EXPECT_FALSE(guard_.is_lost());
  guard_.end();
  EXPECT_EQ(guard_.trouble(), Trouble::none);

  guard_.begin(clock_.now());
  pass(RobotGuard::kSlow + 1ns);
  wait_for_stops(2);
  guard_.end();
}

TEST_F(GuardedRobot, IsLostInATickThatDoesNotEnd) {
  guard_.begin(clock_.now());
  pass(RobotGuard::kStuck + 1ns);
  EXPECT_EQ(guard_.trouble(), Trouble::stuck);
  EXPECT_TRUE(guard_.is_lost());
  wait_for_stops(1);
  while (!guard_.stopped()) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(guard_.signal(), 0);
}

}  // namespace
}  // namespace forcebound::server
