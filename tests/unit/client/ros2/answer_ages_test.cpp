#include "forcebound/client/ros2/answer_ages.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::ros2 {
namespace {

using namespace std::chrono_literals;
using record::ForcePolicy;

record::TickRecord amended(AnswerAges& ages, std::uint64_t sequence, Nanoseconds age) {
  record::TickRecord tick;
  tick.policy = ForcePolicy::fresh;
  tick.force_sequence = sequence;
  tick.force_age = age;
  ages.amend(tick);
  return tick;
}

/// The answer to a motion is added, arrives, and is used by a tick 2 ms after that motion's reading.
record::TickRecord tick_with(AnswerAges& ages, std::uint64_t sequence, const AnswerAges::Answered& answered) {
  ages.add(answered);
  record::ForceRecord force;
  force.force.motion_sequence = sequence;
  force.force.motion_device_time = answered.device_time;
  ages.on_force(force);
  return amended(ages, sequence, 2ms);
}

TEST(AnswerAges, GiveATickTheTimeSinceItsWrenchArrived) {
  AnswerAges ages;
  const record::TickRecord fresh =
      tick_with(ages, 7, {.device_time = 100ms, .policy = ForcePolicy::fresh, .arrival = 90ms});
  EXPECT_EQ(fresh.force_age, 12ms);
  EXPECT_EQ(fresh.policy, ForcePolicy::fresh);
  EXPECT_EQ(fresh.force_sequence, 7U);
  const record::TickRecord old =
      tick_with(ages, 8, {.device_time = 800ms, .policy = ForcePolicy::dropped, .arrival = 90ms});
  EXPECT_EQ(old.force_age, 712ms);
  EXPECT_EQ(old.policy, ForcePolicy::dropped);
}

TEST(AnswerAges, AreNeverBelowZero) {
  AnswerAges ages;
  // Arrived between the reading and its answer, later than the tick began.
  EXPECT_EQ(tick_with(ages, 1, {.device_time = 1ms, .policy = ForcePolicy::fresh, .arrival = 4ms}).force_age, 0ms);
}

TEST(AnswerAges, ATickWithoutAWrenchHasNoForce) {
  AnswerAges ages;
  const record::TickRecord tick = tick_with(ages, 1, {.device_time = 1ms});
  EXPECT_EQ(tick.policy, ForcePolicy::none);
  EXPECT_EQ(tick.force_sequence, 0U);
  EXPECT_EQ(tick.force_age, 0ms);
}

TEST(AnswerAges, PassOverAnswersThatDidNotArriveOrCameTooLate) {
  AnswerAges ages;
  ages.add({.device_time = 1ms, .policy = ForcePolicy::fresh, .arrival = 1ms});
  ages.add({.device_time = 2ms, .policy = ForcePolicy::fresh, .arrival = 1ms});
  EXPECT_EQ(tick_with(ages, 3, {.device_time = 3ms, .policy = ForcePolicy::fresh, .arrival = 1ms}).force_age, 4ms);
  record::ForceRecord late;
  late.force.motion_sequence = 2;
  late.force.motion_device_time = 2ms;
  ages.on_force(late);
  EXPECT_EQ(amended(ages, 3, 5ms).force_age, 7ms);
}

TEST(AnswerAges, CarryThemFromThreadToThread) {
  AnswerAges ages;
  constexpr int kMany = 20000;
  std::jthread server([&ages] {
    for (int i = 1; i <= kMany; ++i) {
      ages.add({.device_time = Nanoseconds{2 * i}, .policy = ForcePolicy::fresh, .arrival = Nanoseconds{i}});
    }
  });
  int given = 0;
  for (int i = 1; i <= kMany; ++i) {
    record::ForceRecord force;
    force.force.motion_sequence = static_cast<std::uint64_t>(i);
    force.force.motion_device_time = Nanoseconds{2 * i};
    ages.on_force(force);
    const Nanoseconds age = amended(ages, force.force.motion_sequence, {}).force_age;
    if (age == Nanoseconds::zero()) continue;  // not yet added, or there was no room for it
    EXPECT_EQ(age, Nanoseconds{i});
    ++given;
  }
  server.join();
  EXPECT_EQ(ages.counts()[1], static_cast<std::uint64_t>(kMany));
  EXPECT_LE(given, kMany);
}

TEST(AnswerAges, DoNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  AnswerAges ages;
  const test::AllocationGuard guard;
  (void)tick_with(ages, 1, {.device_time = 1ms, .policy = ForcePolicy::fresh, .arrival = 1ms});
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::ros2
