#include "tests/tools/netem/slots.hpp"

#include <gtest/gtest.h>

#include <set>

namespace forcebound::netem {
namespace {

using namespace std::chrono_literals;

class SlotsTest : public testing::Test {
 protected:
  Nanoseconds pass(Slots& slots, Nanoseconds ready, std::size_t bytes = 100) {
    return slots.pass(ready, bytes, random_);
  }
  Random random_{1};
};

TEST_F(SlotsTest, WithoutSlotsPacketsLeaveWhenReady) {
  Slots slots({}, 0ns);
  EXPECT_EQ(pass(slots, 17ms), 17ms);
}

TEST_F(SlotsTest, PacketsLeaveOnlyAtSlotTimes) {
  Slots slots({.shortest = 20ms, .longest = 20ms}, 5ms);
  EXPECT_EQ(pass(slots, 5ms), 5ms);
  EXPECT_EQ(pass(slots, 6ms), 25ms);
  EXPECT_EQ(pass(slots, 25ms), 25ms);
  EXPECT_EQ(pass(slots, 26ms), 45ms);
}

TEST_F(SlotsTest, ATimeWithoutPacketsDoesNotShiftRegularSlots) {
  Slots slots({.shortest = 20ms, .longest = 20ms}, 0ns);
  EXPECT_EQ(pass(slots, 24h + 1ns), 24h + 20ms);
}

TEST_F(SlotsTest, AtMostSoManyPacketsLeaveInEach) {
  Slots slots({.shortest = 10ms, .longest = 10ms, .packets = 2}, 0ns);
  EXPECT_EQ(pass(slots, 1ms), 10ms);
  EXPECT_EQ(pass(slots, 1ms), 10ms);
  EXPECT_EQ(pass(slots, 1ms), 20ms);
  EXPECT_EQ(pass(slots, 1ms), 20ms);
  EXPECT_EQ(pass(slots, 2ms), 30ms);
}

TEST_F(SlotsTest, AtMostSoManyBytesLeaveInEach) {
  Slots slots({.shortest = 10ms, .longest = 10ms, .bytes = 250}, 0ns);
  EXPECT_EQ(pass(slots, 1ms, 100), 10ms);
  EXPECT_EQ(pass(slots, 1ms, 100), 10ms);
  EXPECT_EQ(pass(slots, 1ms, 100), 20ms);
}

TEST_F(SlotsTest, PacketLargerThanASlotLeavesInOneOfItsOwn) {
  Slots slots({.shortest = 10ms, .longest = 10ms, .bytes = 250}, 0ns);
  EXPECT_EQ(pass(slots, 1ms, 1000), 10ms);
  EXPECT_EQ(pass(slots, 1ms, 100), 20ms);
}

TEST_F(SlotsTest, IrregularSlotsLieBetweenTheirBounds) {
  Slots slots({.shortest = 10ms, .longest = 30ms, .packets = 1}, 0ns);
  Nanoseconds before = pass(slots, 0ns);
  std::set<Nanoseconds> distinct;
  double sum_ms = 0;
  constexpr int kSlots = 10'000;
  for (int i = 0; i < kSlots; ++i) {
    const Nanoseconds opens = pass(slots, before);
    ASSERT_GE(opens - before, 10ms);
    ASSERT_LT(opens - before, 30ms);
    distinct.insert(opens - before);
    sum_ms += static_cast<double>((opens - before).count()) * 1e-6;
    before = opens;
  }
  EXPECT_NEAR(sum_ms / kSlots, 20, 0.3);
  EXPECT_GT(distinct.size(), 9'000U);
}

TEST_F(SlotsTest, IrregularSlotsOpenWithinTheLongestOneAfterATimeWithoutPackets) {
  Slots slots({.shortest = 0ms, .longest = 1us}, 0ns);
  const Nanoseconds opens = pass(slots, 24h);
  EXPECT_GE(opens, 24h);
  EXPECT_LE(opens, 24h + 1us);
}

DeliveryOpportunities opportunities(std::vector<Nanoseconds> times, Nanoseconds origin = 0ns) {
  return {DeliveryTrace(std::move(times)), origin};
}

TEST(DeliveryOpportunities, EachCarriesOneFullPacket) {
  auto link = opportunities({5ms, 5ms, 10ms});
  EXPECT_EQ(link.pass(0ms, 1500), 5ms);
  EXPECT_EQ(link.pass(0ms, 1500), 5ms);
  EXPECT_EQ(link.pass(0ms, 1500), 10ms);
}

TEST(DeliveryOpportunities, SmallPacketsShareOneAndLargeOnesSpanSeveral) {
  auto link = opportunities({5ms, 10ms, 15ms});
  EXPECT_EQ(link.pass(0ms, 500), 5ms);
  EXPECT_EQ(link.pass(0ms, 1000), 5ms);
  EXPECT_EQ(link.pass(0ms, 1000), 10ms);
  EXPECT_EQ(link.pass(0ms, 1000), 15ms);  // its first 500 bytes left at 10 ms
}

TEST(DeliveryOpportunities, UnusedOpportunitiesAreLost) {
  auto link = opportunities({5ms, 10ms, 15ms});
  EXPECT_EQ(link.pass(6ms, 1500), 10ms);
  EXPECT_EQ(link.pass(15ms, 1500), 15ms);
}

TEST(DeliveryOpportunities, ScheduleStartsOverAtItsLastTime) {
  auto link = opportunities({5ms, 10ms}, 1s);
  EXPECT_EQ(link.pass(1s, 1500), 1005ms);
  EXPECT_EQ(link.pass(1s, 1500), 1010ms);
  EXPECT_EQ(link.pass(1s, 1500), 1015ms);
  EXPECT_EQ(link.pass(1s + 10ms * 1000, 1500), 1s + 10ms * 1000);
  EXPECT_EQ(link.pass(1s + 10ms * 1000, 1500), 1s + 10ms * 1000 + 5ms);
}

}  // namespace
}  // namespace forcebound::netem
