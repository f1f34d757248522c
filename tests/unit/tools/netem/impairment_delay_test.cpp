#include <gmock/gmock.h>

#include <cmath>

#include "tests/unit/tools/netem/impairment_harness.hpp"

namespace forcebound::netem {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing_support::Way;

// One packet of 1000 bytes on the wire.
const std::string kPayload(1000 - kIpUdpHeaderBytes - kEthernetHeaderBytes, 'x');

TEST(ImpairmentDelay, PerfectNetworkDeliversAtOnce) {
  Impairment perfect({});
  perfect.push(5ms, testing_support::bytes_of("hello"), 42);
  EXPECT_EQ(perfect.next_departure(), 5ms);
  const auto departure = perfect.pop(5ms);
  ASSERT_TRUE(departure);
  EXPECT_EQ(departure->time(), 5ms);
  EXPECT_EQ(departure->tag, 42U);
  EXPECT_EQ(departure->bytes.size(), 5U);
  EXPECT_EQ(perfect.next_departure(), std::nullopt);
}

TEST(ImpairmentDelay, NothingLeavesBeforeItsTime) {
  Impairment impairment({.netem = parse_netem("delay 50ms")});
  impairment.push(0ms, testing_support::bytes_of("x"));
  EXPECT_EQ(impairment.next_departure(), 50ms);
  EXPECT_FALSE(impairment.pop(50ms - 1ns));
  EXPECT_TRUE(impairment.pop(50ms));
}

TEST(ImpairmentDelay, NegativeDelayMeansAtOnce) {
  Way way("delay 1ms 10ms");
  for (int i = 0; i < 1000; ++i) way.send(i * 100ms);
  int at_once = 0;
  for (const auto& left : way.finish()) {
    EXPECT_GE(left.verdict.delay, 0ns);
    EXPECT_LT(left.verdict.delay, 11ms);
    at_once += left.verdict.delay == 0ns ? 1 : 0;
  }
  EXPECT_NEAR(at_once, 450, 50);  // uniform in -9 to 11 ms
}

TEST(ImpairmentDelay, UniformJitterOverAMillionPacketsHasItsMeanAndVariance) {
  Impairment impairment({.netem = parse_netem("delay 50ms 10ms")});
  constexpr int kPackets = 1'000'000;
  double sum_ms = 0;
  double squares = 0;
  int left = 0;
  const auto drain = [&](Nanoseconds now) {
    while (const auto departure = impairment.pop(now)) {
      const double ms = static_cast<double>(departure->verdict.delay.count()) * 1e-6;
      sum_ms += ms;
      squares += ms * ms;
      ++left;
    }
  };
  for (int i = 0; i < kPackets; ++i) {
    drain(i * 1ms);
    impairment.push(i * 1ms, {});
  }
  drain(Nanoseconds::max());
  ASSERT_EQ(left, kPackets);
  const double mean = sum_ms / kPackets;
  EXPECT_NEAR(mean, 50, 0.03);
  EXPECT_NEAR(squares / kPackets - mean * mean, 100.0 / 3, 0.1);
}

TEST(ImpairmentDelay, JitterLargerThanTheSpacingReordersPackets) {
  Way way("delay 50ms 10ms");
  for (int i = 0; i < 1000; ++i) way.send(i * 1ms);
  way.finish();
  const auto numbers = way.numbers();
  ASSERT_EQ(numbers.size(), 1000U);
  EXPECT_FALSE(std::is_sorted(numbers.begin(), numbers.end()));
}

TEST(ImpairmentDelay, PacketsLeaveInTheOrderOfTheirTimes) {
  Way way("delay 50ms 20ms distribution normal duplicate 10%");
  for (int i = 0; i < 10'000; ++i) way.send(i * 1ms);
  Nanoseconds before{0};
  for (const auto& left : way.finish()) {
    ASSERT_GE(left.time, before);
    before = left.time;
  }
}

TEST(ImpairmentDelay, RateSpacesPacketsByTheirSizeOnTheWire) {
  Way way("rate 1Mbit");  // 8 ms for 1000 bytes
  for (int i = 0; i < 4; ++i) way.send(0ms, kPayload);
  way.finish();
  way.send(100ms, kPayload);  // the line is free again
  std::vector<Nanoseconds> times;
  for (const auto& left : way.finish()) times.push_back(left.time);
  EXPECT_THAT(times, ElementsAre(8ms, 16ms, 24ms, 32ms, 108ms));
}

TEST(ImpairmentDelay, RateComesAfterDelay) {
  Way way("delay 50ms rate 1Mbit");
  way.send(0ms, kPayload);
  way.send(1ms, kPayload);
  way.send(40ms, kPayload);
  std::vector<Nanoseconds> times;
  for (const auto& left : way.finish()) times.push_back(left.time);
  EXPECT_THAT(times, ElementsAre(58ms, 66ms, 98ms));
}

TEST(ImpairmentDelay, RateCountsOverheadAndWholeCells) {
  // 1000 + 10 bytes are 22 cells of 48, each 53 on the wire.
  Way way("rate 1Mbit 10 48 5");
  way.send(0ms, kPayload);
  EXPECT_EQ(way.finish().front().time, Nanoseconds{22 * 53 * 8'000});
  Way shrunk("rate 1Mbit -500");
  shrunk.send(0ms, kPayload);
  EXPECT_EQ(shrunk.finish().front().time, 4ms);
  Way vanished("rate 1Mbit -2000");
  vanished.send(0ms, kPayload);
  EXPECT_EQ(vanished.finish().front().time, 0ms);
}

TEST(ImpairmentDelay, WithRatePacketsCannotPassEachOther) {
  Way way("delay 50ms 10ms rate 100Mbit");
  for (int i = 0; i < 10'000; ++i) way.send(i * 1ms);
  way.finish();
  const auto numbers = way.numbers();
  ASSERT_EQ(numbers.size(), 10'000U);
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
}

TEST(ImpairmentDelay, RateDeliversWhatItPromisesOverAMillionPackets) {
  Impairment impairment({.netem = parse_netem("rate 8Mbit limit 10")});
  constexpr int kPackets = 1'000'000;
  // Twice what the line takes: 84 bytes on the wire are 84 us, one comes every 42 us.
  const std::vector<std::byte> payload(42);
  std::uint64_t left = 0;
  for (int i = 0; i < kPackets; ++i) {
    const Nanoseconds now = i * 42us;
    while (impairment.pop(now)) ++left;
    impairment.push(now, payload);
  }
  EXPECT_NEAR(static_cast<double>(left), 0.5 * kPackets, 10);
  EXPECT_EQ(impairment.counters().over_limit + left + impairment.waiting(), std::uint64_t{kPackets});
}

TEST(ImpairmentDelay, SlotsHoldBackWhatIsReady) {
  Way way("delay 5ms slot 20ms packets 2");
  for (int i = 0; i < 5; ++i) way.send(i * 1ms);
  std::vector<Nanoseconds> times;
  for (const auto& left : way.finish()) times.push_back(left.time);
  EXPECT_THAT(times, ElementsAre(20ms, 20ms, 40ms, 40ms, 60ms));
  EXPECT_THAT(way.numbers(), ElementsAre(1, 2, 3, 4, 5));
}

TEST(ImpairmentDelay, SlotsCountBytesOnTheWire) {
  Way way("slot 20ms bytes 2000");
  for (int i = 0; i < 4; ++i) way.send(1ms, kPayload);
  std::vector<Nanoseconds> times;
  for (const auto& left : way.finish()) times.push_back(left.time);
  EXPECT_THAT(times, ElementsAre(20ms, 20ms, 40ms, 40ms));
}

TEST(ImpairmentDelay, AChangeHoldsForWhatComesAfterIt) {
  Way way("delay 30ms limit 1");
  way.send(0ms);
  way.impairment().change(1ms, parse_netem("delay 5ms"));
  way.send(1ms);
  const auto& left = way.finish();
  ASSERT_EQ(left.size(), 2U) << "the limit is the new one";
  EXPECT_EQ(left[0].time, 6ms);
  EXPECT_EQ(left[1].time, 30ms);
}

TEST(ImpairmentDelay, TraceAddsItsDelayAndItsBlackouts) {
  Way way({.netem = parse_netem("delay 1ms"), .trace = RttTrace({{0s, 20ms}, {2s, 20ms}, {3s, 40ms}}), .origin = 10s});
  way.send(10s);
  const Verdicts lost = way.send(11s);
  EXPECT_EQ(lost.begin()->fate, Fate::blackout);
  way.send(12500ms);
  const auto& left = way.finish();
  ASSERT_EQ(left.size(), 2U);
  EXPECT_EQ(left[0].verdict.delay, 11ms);
  EXPECT_EQ(left[1].verdict.delay, 16ms);
  EXPECT_EQ(way.counters().blackout, 1U);
}

TEST(ImpairmentDelay, TraceOfSecondsIsNotCutByNetemsDefaultLimit) {
  Way way({.netem = {}, .trace = RttTrace({{0s, 12s}})});
  for (int i = 0; i < 6000; ++i) way.send(i * 1ms);
  EXPECT_EQ(way.finish().size(), 6000U);
  Way limited({.netem = parse_netem("limit 10"), .trace = RttTrace({{0s, 12s}})});
  for (int i = 0; i < 100; ++i) limited.send(i * 1ms);
  EXPECT_EQ(limited.finish().size(), 10U);
}

TEST(ImpairmentDelay, MahimahiTraceCarriesPacketsAtItsOpportunities) {
  // 1472 bytes of payload and 28 of headers are one opportunity.
  const std::string full(1500 - kIpUdpHeaderBytes, 'x');
  Way way({.netem = {}, .trace = DeliveryTrace({5ms, 10ms})});
  for (int i = 0; i < 3; ++i) way.send(0ms, full);
  std::vector<Nanoseconds> times;
  for (const auto& left : way.finish()) times.push_back(left.time);
  EXPECT_THAT(times, ElementsAre(5ms, 10ms, 15ms));
}

TEST(ImpairmentDelay, SlotsComeBeforeTheOpportunitiesOfATrace) {
  Way way({.netem = parse_netem("slot 7ms"), .trace = DeliveryTrace({5ms, 10ms})});
  way.send(1ms);
  EXPECT_EQ(way.finish().front().time, 10ms);
}

}  // namespace
}  // namespace forcebound::netem
