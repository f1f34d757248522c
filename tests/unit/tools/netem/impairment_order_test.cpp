#include <gmock/gmock.h>

#include <bit>

#include "tests/unit/tools/netem/impairment_harness.hpp"

namespace forcebound::netem {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing_support::Way;

TEST(ImpairmentOrder, ABlackholeDropsWithoutADraw) {
  const NetemParameters netem = parse_netem("loss 50%");
  Way whole({.netem = netem, .seed = 3, .origin = 1s});
  Way holed({.netem = netem, .blackholes = {{10ms, 20ms}, {30ms, 31ms}}, .seed = 3, .origin = 1s});
  const auto in_a_hole = [](int ms) { return (ms >= 10 && ms < 20) || ms == 30; };
  for (int ms = 0; ms < 100; ++ms) {
    const Fate fate = holed.send(1s + ms * 1ms).begin()->fate;
    EXPECT_EQ(fate == Fate::blackout, in_a_hole(ms)) << ms;
    if (!in_a_hole(ms)) {
      EXPECT_EQ(fate, whole.send(1s + ms * 1ms).begin()->fate) << ms;
    }
  }
  EXPECT_EQ(holed.counters().blackout, 11U);
  EXPECT_EQ(holed.counters().received, 100U);
}

TEST(ImpairmentOrder, DuplicateSendsTheCopyFirst) {
  Way way("duplicate 100%");
  const Verdicts verdicts = way.send(0ms);
  ASSERT_EQ(verdicts.size(), 2U);
  EXPECT_TRUE(verdicts.begin()->copy);
  EXPECT_FALSE((verdicts.begin() + 1)->copy);
  const auto& left = way.finish();
  ASSERT_EQ(left.size(), 2U);
  EXPECT_TRUE(left[0].verdict.copy);
  EXPECT_FALSE(left[1].verdict.copy);
  EXPECT_EQ(way.counters().duplicated, 1U);
}

TEST(ImpairmentOrder, DuplicatesTheGivenShare) {
  Impairment impairment({.netem = parse_netem("duplicate 2%")});
  for (int i = 0; i < 1'000'000; ++i) {
    impairment.push(i * 1us, {});
    while (impairment.pop(i * 1us)) continue;
  }
  EXPECT_NEAR(static_cast<double>(impairment.counters().duplicated), 20'000, 600);
  EXPECT_EQ(impairment.counters().forwarded, 1'000'000 + impairment.counters().duplicated);
}

TEST(ImpairmentOrder, LossOfADuplicatedPacketOnlyCancelsTheCopy) {
  Way way("duplicate 100% loss 100%");
  for (int i = 0; i < 100; ++i) way.send(i * 1ms);
  EXPECT_EQ(way.finish().size(), 100U);
  EXPECT_EQ(way.counters().lost, 0U);
  EXPECT_EQ(way.counters().duplicated, 0U);
}

TEST(ImpairmentOrder, CopyGoesThroughLossToo) {
  // Not lost at first (1/2), then the copy is lost with 1/2: a quarter of all packets.
  Way way("duplicate 100% loss 50%");
  for (int i = 0; i < 10'000; ++i) way.send(i * 1ms);
  way.finish();
  EXPECT_NEAR(static_cast<double>(way.counters().lost), 2'500, 200);
  EXPECT_NEAR(static_cast<double>(way.counters().duplicated), 5'000, 250);
}

TEST(ImpairmentOrder, CorruptFlipsOneBitOfOneByte) {
  Way way("corrupt 100%");
  const std::string text(100, '\0');
  std::array<int, 100> hits{};
  for (int i = 0; i < 10'000; ++i) way.send(i * 1ms, text);
  for (const auto& left : way.finish()) {
    int bits = 0;
    for (std::size_t k = 0; k < left.bytes.size(); ++k) {
      const int flipped = std::popcount(static_cast<unsigned char>(left.bytes[k]));
      bits += flipped;
      hits[k] += flipped;
    }
    ASSERT_EQ(bits, 1);
    ASSERT_TRUE(left.verdict.corrupted);
  }
  EXPECT_GT(*std::min_element(hits.begin(), hits.end()), 50);  // 100 expected at each byte
  EXPECT_EQ(way.counters().corrupted, 10'000U);
}

TEST(ImpairmentOrder, CopyIsTakenBeforeCorruption) {
  // Each of the two is corrupted with 1/2 on its own, so a quarter of the pairs has an intact copy only.
  Way way("duplicate 100% corrupt 50%");
  for (int i = 0; i < 1000; ++i) way.send(i * 1ms, "x");
  int only_the_copy_is_intact = 0;
  const auto& left = way.finish();
  for (std::size_t i = 0; i + 1 < left.size(); i += 2)
    only_the_copy_is_intact += left[i].bytes == "x" && left[i + 1].bytes != "x" ? 1 : 0;
  EXPECT_NEAR(only_the_copy_is_intact, 250, 50);
}

TEST(ImpairmentOrder, EmptyDatagramHasNoBitToFlip) {
  Way way("corrupt 100%");
  way.send(0ms, "");
  EXPECT_FALSE(way.finish().front().verdict.corrupted);
}

TEST(ImpairmentOrder, FullQueueDropsWhatComes) {
  Way way("delay 100ms limit 3");
  for (int i = 0; i < 5; ++i) way.send(i * 1ms);
  const Verdicts verdicts = way.send(5ms);
  EXPECT_EQ(verdicts.begin()->fate, Fate::over_limit);
  EXPECT_EQ(way.counters().over_limit, 3U);
  way.send(101ms);  // numbers 1 and 2 have left
  way.finish();
  EXPECT_THAT(way.numbers(), ElementsAre(1, 2, 3, 7));
}

TEST(ImpairmentOrder, QueueHoldsAThousandPacketsByDefault) {
  Way way("delay 10s");
  for (int i = 0; i < 1500; ++i) way.send(i * 1us);
  EXPECT_EQ(way.finish().size(), 1000U);
  EXPECT_EQ(way.counters().over_limit, 500U);
}

TEST(ImpairmentOrder, FullQueueDropsTheCopyWithItsPacket) {
  Way way("delay 100ms duplicate 100% limit 2");
  way.send(0ms);
  EXPECT_EQ(way.send(0ms).size(), 1U);
  EXPECT_EQ(way.finish().size(), 2U);
  EXPECT_EQ(way.counters().duplicated, 1U);
}

TEST(ImpairmentOrder, ReorderWithGapSendsEveryNthPacketAtOnce) {
  Way way("delay 10ms reorder 100% gap 5");
  for (int i = 0; i < 10; ++i) way.send(i * 1ms);
  way.finish();
  // Numbers 5 and 10 go at once, at 4 and 9 ms; number 1 leaves at 10 ms.
  EXPECT_THAT(way.numbers(), ElementsAre(5, 10, 1, 2, 3, 4, 6, 7, 8, 9));
  EXPECT_EQ(way.counters().reordered, 2U);
}

TEST(ImpairmentOrder, ReorderedPacketLeavesBeforeOthersThatAreDue) {
  Impairment impairment({.netem = parse_netem("delay 10ms reorder 100% gap 3")});
  impairment.push(0ms, {}, 1);
  impairment.push(0ms, {}, 2);
  impairment.push(10ms, {}, 3);  // the others are due now as well
  EXPECT_EQ(impairment.next_departure(), 10ms);
  EXPECT_EQ(impairment.pop(10ms)->tag, 3U);
  EXPECT_EQ(impairment.pop(10ms)->tag, 1U);
  EXPECT_EQ(impairment.pop(10ms)->tag, 2U);
}

TEST(ImpairmentOrder, ReorderWithoutGapPicksByItsShareAlone) {
  Impairment impairment({.netem = parse_netem("delay 10ms reorder 25%")});
  for (int i = 0; i < 1'000'000; ++i) {
    impairment.push(i * 1ms, {});
    while (impairment.pop(i * 1ms)) continue;
  }
  EXPECT_NEAR(static_cast<double>(impairment.counters().reordered), 250'000, 2'000);
}

TEST(ImpairmentOrder, ReorderWithGapAndShareWaitsOnAverage) {
  // After each hit gap-1 = 4 are delayed for certain, then 1/p = 4 tries until the next: one hit in 8.
  Impairment impairment({.netem = parse_netem("delay 10ms reorder 25% gap 5")});
  for (int i = 0; i < 1'000'000; ++i) {
    impairment.push(i * 1ms, {});
    while (impairment.pop(i * 1ms)) continue;
  }
  EXPECT_NEAR(static_cast<double>(impairment.counters().reordered), 125'000, 1'000);
}

TEST(ImpairmentOrder, ReorderedPacketsSkipSlots) {
  Way way("delay 1ms slot 20ms reorder 100% gap 2");
  way.send(1ms);
  way.send(2ms);
  const auto& left = way.finish();
  EXPECT_THAT(way.numbers(), ElementsAre(2, 1));
  EXPECT_EQ(left[0].time, 2ms);
  EXPECT_EQ(left[1].time, 20ms);
}

TEST(ImpairmentOrder, EveryPacketIsAccountedFor) {
  Way way("delay 20ms 10ms loss gemodel 2% 20% duplicate 5% 5% corrupt 1% reorder 10% 30% gap 3 limit 20");
  for (int i = 0; i < 100'000; ++i) way.send(i * 1ms);
  const ImpairmentCounters& counted = way.counters();
  EXPECT_EQ(counted.received + counted.duplicated,
            counted.forwarded + counted.lost + counted.over_limit + counted.blackout + way.impairment().waiting());
  for (const std::uint64_t count :
       {counted.lost, counted.duplicated, counted.corrupted, counted.reordered, counted.over_limit})
    EXPECT_GT(count, 0U);
  way.finish();
  EXPECT_EQ(way.impairment().waiting(), 0U);
}

}  // namespace
}  // namespace forcebound::netem
