#include "forcebound/wire/version_mismatch.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::wire {
namespace {

TEST(VersionMismatch, NamesBothVersionsAndTheOlderEnd) {
  EXPECT_EQ(VersionMismatch(1, 2).text(),
            "the server speaks protocol version 1, the client version 2: update the server");
  EXPECT_EQ(VersionMismatch(2, 1).text(),
            "the server speaks protocol version 2, the client version 1: update the client");
}

TEST(VersionMismatch, HasRoomForEveryVersion) {
  constexpr auto kLargest = std::numeric_limits<std::uint32_t>::max();
  EXPECT_TRUE(VersionMismatch(kLargest, kLargest).text().ends_with("4294967295: update the client"));
}

TEST(VersionMismatch, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const test::AllocationGuard guard;
  EXPECT_FALSE(VersionMismatch(1, 2).text().empty());
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::wire
