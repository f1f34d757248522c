#include "forcebound/time/periodic_timer.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "forcebound/time/steady_clock.hpp"

namespace forcebound::time {
namespace {

using namespace std::chrono_literals;

TEST(PeriodicTimer, NeverWakesBeforeItIsDue) {
  const SteadyClock clock;
  PeriodicTimer timer(clock, 1ms);
  for (int i = 0; i < 20; ++i) {
    const Nanoseconds woken = timer.wait();
    EXPECT_GE(woken, timer.due());
  }
}

TEST(PeriodicTimer, StaysOnItsGridHoweverLateItWakes) {
  const SteadyClock clock;
  PeriodicTimer timer(clock, 1ms);
  const Nanoseconds start = timer.due();
  for (int i = 0; i < 20; ++i) {
    timer.wait();
    EXPECT_EQ((timer.due() - start) % 1ms, 0ns);
  }
}

TEST(PeriodicTimer, LeavesOutMissedTicksInsteadOfABurst) {
  const SteadyClock clock;
  PeriodicTimer timer(clock, 1ms);
  const Nanoseconds stalled_until = clock.now() + 12ms;
  while (clock.now() < stalled_until) {
  }
  const Nanoseconds woken = timer.wait();
  EXPECT_GE(timer.missed(), 10U);
  EXPECT_GE(timer.due() + 1ms, stalled_until) << "no missed tick is made up for";
  EXPECT_GE(woken, stalled_until);
}

TEST(PeriodicTimer, RefusesAPeriodThatIsNotPositive) {
  const SteadyClock clock;
  EXPECT_THROW(PeriodicTimer(clock, 0ns), std::invalid_argument);
  EXPECT_THROW(PeriodicTimer(clock, -1ms), std::invalid_argument);
}

TEST(FromSeconds, RoundsToTheNearestNanosecondAndSaturates) {
  EXPECT_EQ(from_seconds(1e-9), 1ns);
  EXPECT_EQ(from_seconds(-1.6e-9), -2ns);
  EXPECT_EQ(from_seconds(1e300), Nanoseconds::max());
  EXPECT_EQ(from_seconds(-1e300), Nanoseconds::min());
  EXPECT_EQ(from_seconds(std::numeric_limits<double>::quiet_NaN()), Nanoseconds::min());
}

}  // namespace
}  // namespace forcebound::time
