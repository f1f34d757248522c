#include "tests/tools/sim/tick_schedule.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;

std::vector<Nanoseconds> wakes(const TickTiming& timing, int count, std::uint64_t seed = 1) {
  TickSchedule schedule(timing, 1ms, seed);
  std::vector<Nanoseconds> result;
  Nanoseconds free{0};
  for (int i = 0; i < count; ++i) {
    result.push_back(schedule.next_wake(free));
    free = result.back() + 1ns;
  }
  return result;
}

TEST(TickSchedule, IsPunctualUnlessToldOtherwise) {
  const auto times = wakes({}, 1000);
  for (std::size_t i = 0; i < times.size(); ++i) ASSERT_EQ(times[i], 1ms * static_cast<int>(i + 1));
}

TEST(TickSchedule, MakesTheShareOfTicksLateThatWasAskedForAndShiftsNoOther) {
  const auto times = wakes({.late_share = 0.2, .late_max = 1ms}, 100'000);
  int late = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const Nanoseconds by = times[i] - 1ms * static_cast<int>(i + 1);
    ASSERT_GE(by, 0ns);
    ASSERT_LT(by, 1ms + 1us);
    late += by > 0ns;
  }
  EXPECT_NEAR(late, 20'000, 500);
}

TEST(TickSchedule, LeavesOutTicksThatWereMissedAltogether) {
  TickSchedule schedule({}, 1ms, 1);
  EXPECT_EQ(schedule.next_wake(0ns), 1ms);
  EXPECT_EQ(schedule.next_wake(7ms + 300us), 7ms + 300us) << "at once";
  EXPECT_EQ(schedule.next_wake(7ms + 301us), 8ms) << "and then at its old times";
}

TEST(TickSchedule, IsAsLateAsWasMeasured) {
  auto times = wakes({.measured = true}, 200'000);
  std::vector<Nanoseconds> late;
  Nanoseconds before{0};
  for (const Nanoseconds time : times) {
    late.push_back(time % 1ms);
    ASSERT_GT(time, before);
    before = time;
  }
  std::nth_element(late.begin(), late.begin() + 100'000, late.end());
  EXPECT_GT(late[100'000], 30us);
  EXPECT_LT(late[100'000], 50us);
}

TEST(TickSchedule, IsTheSameForTheSameSeed) {
  const TickTiming timing{.late_share = 0.5, .late_max = 3ms, .measured = true};
  EXPECT_EQ(wakes(timing, 1000, 5), wakes(timing, 1000, 5));
  EXPECT_NE(wakes(timing, 1000, 5), wakes(timing, 1000, 6));
}

TEST(TickSchedule, ChoosesBeforeItCommands) {
  TickSchedule schedule({.choosing_max = 100us}, 1ms, 3);
  int long_before = 0;
  for (int i = 0; i < 10'000; ++i) {
    const Nanoseconds commanded = schedule.next_choosing();
    const Nanoseconds chosen = schedule.next_chosen(commanded);
    ASSERT_LE(commanded, 100us);
    ASSERT_GE(chosen, 0ns);
    ASSERT_LE(chosen, commanded);
    long_before += commanded - chosen > 20us;
  }
  EXPECT_GT(long_before, 10);
  EXPECT_LT(long_before, 1000);
}

}  // namespace
}  // namespace forcebound::sim
