#include "forcebound/server/security/waiting_handshakes.hpp"

#include <gtest/gtest.h>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::server {
namespace {

WaitingHandshakes::Waiting waiting_of(std::uint64_t who, std::uint32_t client) {
  return {.topic = {.client = client}, .who = who};
}

TEST(WaitingHandshakes, AreTakenInTheOrderInWhichTheyCame) {
  WaitingHandshakes waiting;
  for (std::uint32_t round = 0; round < 3 * WaitingHandshakes::kMost; ++round) {
    EXPECT_TRUE(waiting.put(waiting_of(1, round)));
    EXPECT_TRUE(waiting.put(waiting_of(2, round + 1)));
    EXPECT_EQ(waiting.take()->topic.client, round);
    EXPECT_EQ(waiting.take()->topic.client, round + 1);
    EXPECT_TRUE(waiting.empty());
  }
  EXPECT_FALSE(waiting.take());
}

TEST(WaitingHandshakes, AreFewOfEachAndBoundedInAll) {
  WaitingHandshakes waiting;
  for (std::size_t i = 0; i < WaitingHandshakes::kOfOneMost; ++i) EXPECT_TRUE(waiting.put(waiting_of(1, 1)));
  EXPECT_FALSE(waiting.put(waiting_of(1, 1)));
  EXPECT_TRUE(waiting.put(waiting_of(2, 1))) << "another one has room";
  std::size_t more = 0;
  for (std::uint64_t who = 3; who < 1000; ++who) more += waiting.put(waiting_of(who, 1)) ? 1 : 0;
  EXPECT_EQ(more, WaitingHandshakes::kMost - WaitingHandshakes::kOfOneMost - 1);
}

TEST(WaitingHandshakes, DoNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  WaitingHandshakes waiting;
  const test::AllocationGuard guard;
  const bool put = waiting.put(waiting_of(1, 1));
  const bool taken = waiting.take().has_value();
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_TRUE(put && taken);
}

}  // namespace
}  // namespace forcebound::server
