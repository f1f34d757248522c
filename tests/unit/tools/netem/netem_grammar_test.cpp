#include <gmock/gmock.h>

#include <stdexcept>

#include "tests/tools/netem/netem_parameters.hpp"
#include "tests/tools/netem/netem_values.hpp"

namespace forcebound::netem {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

constexpr Share share(double percent) { return static_cast<Share>(percent / 100 * kCertain + 0.5); }

TEST(NetemGrammar, NoWordsMeanPerfectNetwork) {
  EXPECT_EQ(parse_netem(""), NetemParameters{});
  EXPECT_EQ(parse_netem(" \t\n"), NetemParameters{});
  EXPECT_EQ(kLimitPackets, 1000U);
}

TEST(NetemGrammar, ReadsDelayJitterCorrelationAndDistribution) {
  const Delay delay = parse_netem("delay 50ms 10ms 25% distribution paretonormal").delay;
  EXPECT_EQ(delay, (Delay{50ms, 10ms, share(25), DelayShape::paretonormal}));
  EXPECT_EQ(parse_netem("delay 50ms 10ms distribution normal").delay.shape, DelayShape::normal);
  EXPECT_EQ(parse_netem("delay 50ms 10ms distribution pareto").delay.shape, DelayShape::pareto);
  EXPECT_EQ(parse_netem("delay 50ms 10ms").delay, (Delay{50ms, 10ms, 0, DelayShape::uniform}));
  EXPECT_EQ(parse_netem("delay 50ms").delay, (Delay{50ms, 0ms, 0, DelayShape::uniform}));
}

TEST(NetemGrammar, TimeWithoutUnitIsMicroseconds) {
  EXPECT_EQ(parse_netem("delay 50").delay.mean, 50us);
  EXPECT_EQ(parse_netem("delay 50 10").delay.jitter, 10us);
  EXPECT_EQ(parse_netem("slot 800").slot.shortest, 800us);
}

TEST(NetemGrammar, SaysTheUnitsOfNumbersWithoutOne) {
  EXPECT_EQ(with_units("delay 50 10  25 loss gemodel 1 10 reorder 5 gap 3"),
            "delay 50us 10us 25% loss gemodel 1% 10% reorder 5% gap 3");
  EXPECT_EQ(with_units("rate 8000 14 slot 800 1e3 packets 2 limit 7"),
            "rate 8000bit 14 slot 800us 1e3us packets 2 limit 7");
  EXPECT_EQ(with_units("delay 50ms 1.5S 5% distribution normal"), "delay 50ms 1.5S 5% distribution normal");
  EXPECT_EQ(with_units(""), "");
}

TEST(NetemGrammar, ReadsEveryUnitOfTime) {
  for (const char* text :
       {"1.5s", "1.5sec", "1.5secs", "1500ms", "1500msec", "1500msecs", "1500000us", "1500000usec", "1500000usecs",
        "1500000000ns", "1500000000nsec", "1500000000nsecs", "1500000", "1.5e6", "1.5S", "1500MS"})
    EXPECT_EQ(parse_netem("delay " + std::string(text)).delay.mean, 1500ms) << text;
}

TEST(NetemGrammar, ReadsLossWithAndWithoutRandom) {
  const Loss expected = RandomLoss{{share(5), share(25)}};
  EXPECT_EQ(parse_netem("loss 5% 25%").loss, expected);
  EXPECT_EQ(parse_netem("loss random 5% 25%").loss, expected);
  EXPECT_EQ(parse_netem("loss 5 25").loss, expected);
  EXPECT_EQ(parse_netem("loss 100%").loss, Loss(RandomLoss{{kCertain, 0}}));
}

TEST(NetemGrammar, FillsInDefaultsOfGemodel) {
  EXPECT_EQ(parse_netem("loss gemodel 1%").loss, Loss(GilbertElliottLoss{share(1), kCertain - share(1), kCertain, 0}));
  EXPECT_EQ(parse_netem("loss gemodel 1% 10%").loss, Loss(GilbertElliottLoss{share(1), share(10), kCertain, 0}));
  EXPECT_EQ(parse_netem("loss gemodel 1% 10% 70% 0.1%").loss,
            Loss(GilbertElliottLoss{share(1), share(10), share(70), share(0.1)}));
}

TEST(NetemGrammar, FillsInDefaultsOfState) {
  EXPECT_EQ(parse_netem("loss state 1%").loss, Loss(FourStateLoss{share(1), kCertain - share(1), 0, kCertain, 0}));
  EXPECT_EQ(parse_netem("loss state 1% 10% 20% 80% 0.5%").loss,
            Loss(FourStateLoss{share(1), share(10), share(20), share(80), share(0.5)}));
}

TEST(NetemGrammar, ReadsDuplicateCorruptAndLimit) {
  const NetemParameters read = parse_netem("duplicate 1% 2% corrupt 3% 4% limit 20");
  EXPECT_EQ(read.duplicate, (Chance{share(1), share(2)}));
  EXPECT_EQ(read.corrupt, (Chance{share(3), share(4)}));
  EXPECT_EQ(read.limit_packets, 20U);
}

TEST(NetemGrammar, ReorderWithoutGapMayPickEveryPacket) {
  EXPECT_EQ(parse_netem("delay 10ms reorder 25% 50%").reorder, (Reorder{{share(25), share(50)}, 1}));
  EXPECT_EQ(parse_netem("delay 10ms reorder 25% gap 5").reorder, (Reorder{{share(25), 0}, 5}));
  EXPECT_EQ(parse_netem("gap 5 reorder 25% delay 10ms").reorder, (Reorder{{share(25), 0}, 5}));
}

TEST(NetemGrammar, ReadsRates) {
  EXPECT_EQ(parse_netem("rate 1Mbit").rate.bits_per_second, 1'000'000U);
  EXPECT_EQ(parse_netem("rate 64kbit").rate.bits_per_second, 64'000U);
  EXPECT_EQ(parse_netem("rate 64000").rate.bits_per_second, 64'000U);
  EXPECT_EQ(parse_netem("rate 8kbps").rate.bits_per_second, 64'000U);
  EXPECT_EQ(parse_netem("rate 1Kibit").rate.bits_per_second, 1024U);
  EXPECT_EQ(parse_netem("rate 1mbit -14 53 -5").rate, (Rate{1'000'000, -14, 53, -5}));
}

TEST(NetemGrammar, ReadsSlots) {
  EXPECT_EQ(parse_netem("slot 800us 1ms packets 4 bytes 2000").slot, (Slot{800us, 1ms, 4, 2000}));
  EXPECT_EQ(parse_netem("slot 20ms").slot, (Slot{20ms, 20ms, 0, 0}));
  EXPECT_EQ(parse_netem("slot 20ms bytes 64").slot, (Slot{20ms, 20ms, 0, 64}));
}

struct Refusal {
  const char* words;
  const char* offending;
  const char* accepted;
};
void PrintTo(const Refusal& refusal, std::ostream* out) { *out << '"' << refusal.words << '"'; }

class NetemGrammarRefuses : public testing::TestWithParam<Refusal> {};

TEST_P(NetemGrammarRefuses, NamingTheWordAndWhatWouldBeAccepted) {
  EXPECT_THAT([] { parse_netem(GetParam().words); },
              ThrowsMessage<std::invalid_argument>(
                  AllOf(HasSubstr(GetParam().offending), HasSubstr("expected"), HasSubstr(GetParam().accepted))));
}

INSTANTIATE_TEST_SUITE_P(Words, NetemGrammarRefuses,
                         testing::Values(Refusal{"dealy 50ms", "'dealy'", "delay"}, Refusal{"50ms", "'50ms'", "delay"},
                                         Refusal{"delay 50ms 10ms 25% 5%", "'5%'", "slot"},
                                         Refusal{"ecn", "'ecn'", "loss"},
                                         Refusal{"delay 5ms delay 6ms", "'delay' is given twice", "once"},
                                         Refusal{"loss 5% loss 1%", "'loss' is given twice", "once"}));

INSTANTIATE_TEST_SUITE_P(UnitsApart, NetemGrammarRefuses,
                         testing::Values(Refusal{"delay 50 ms", "'ms' stands apart from its number", "50ms"},
                                         Refusal{"loss 5 %", "'%' stands apart from its number", "%;"},
                                         Refusal{"rate 1 Mbit", "'Mbit' stands apart from its number", "bps"}));

INSTANTIATE_TEST_SUITE_P(
    Times, NetemGrammarRefuses,
    testing::Values(Refusal{"delay", "the line ends", "a time for delay"}, Refusal{"delay fast", "'fast'", "50ms"},
                    Refusal{"delay -5ms", "'-5ms'", "0 to 86400s"}, Refusal{"delay 5mss", "'5mss'", "microseconds"},
                    Refusal{"delay 1,5ms", "'1,5ms'", "50ms"}, Refusal{"delay nan", "'nan'", "50ms"},
                    Refusal{"delay inf", "'inf'", "50ms"}, Refusal{"delay 1e300s", "'1e300s'", "86400s"},
                    Refusal{"delay 50ms -1ms", "'-1ms' is not a valid delay jitter", "86400s"}));

INSTANTIATE_TEST_SUITE_P(
    Percentages, NetemGrammarRefuses,
    testing::Values(Refusal{"loss", "the line ends", "a percentage for loss"}, Refusal{"loss 101%", "'101%'", "100%"},
                    Refusal{"loss -1%", "'-1%'", "0%"}, Refusal{"loss 5%%", "'5%%'", "100%"},
                    Refusal{"loss 5% 200%", "'200%' is not a valid loss correlation", "100%"},
                    Refusal{"loss bernoulli 5%", "'bernoulli'", "gemodel"},
                    Refusal{"loss gemodel", "the line ends", "P of loss gemodel"},
                    Refusal{"loss gemodel 1% 1000%", "'1000%' is not a valid R of loss gemodel", "100%"},
                    Refusal{"loss state x", "'x' is not a valid P13", "100%"},
                    Refusal{"duplicate 1ms", "'1ms' is not a valid duplicate", "100%"},
                    Refusal{"corrupt -1", "'-1' is not a valid corrupt", "100%"}));

INSTANTIATE_TEST_SUITE_P(
    Together, NetemGrammarRefuses,
    testing::Values(Refusal{"delay 50ms distribution normal", "'distribution' needs a delay and a jitter", "delay"},
                    Refusal{"distribution normal", "'distribution' needs a delay and a jitter", "delay"},
                    Refusal{"delay 0 10ms distribution normal", "'distribution' needs", "delay"},
                    Refusal{"delay 50ms 10ms distribution gauss", "'gauss'", "paretonormal"},
                    Refusal{"reorder 25%", "'reorder' needs a delay", "delay 10ms reorder"},
                    Refusal{"delay 10ms gap 5", "'gap' needs reorder", "reorder 25% gap 5"},
                    Refusal{"delay 10ms reorder 0% gap 5", "'gap' needs reorder", "reorder 25% gap 5"},
                    Refusal{"delay 10ms reorder 5% gap 0", "'0' is not a valid gap", "1 to"}));

INSTANTIATE_TEST_SUITE_P(
    Numbers, NetemGrammarRefuses,
    testing::Values(Refusal{"rate 0", "'0' is not a valid rate", "above 0"}, Refusal{"rate 1Mbot", "'1Mbot'", "1Mbit"},
                    Refusal{"rate -5kbit", "'-5kbit'", "above 0"}, Refusal{"rate 50%", "'50%'", "1Mbit"},
                    Refusal{"rate 1Mbit 5.5", "'5.5' is not a valid packet overhead", "whole number"},
                    Refusal{"rate 1Mbit 5 -1", "'-1' is not a valid cell size", "from 0"},
                    Refusal{"limit -1", "'-1' is not a valid limit", "from 0"},
                    Refusal{"limit ten", "'ten'", "whole number"},
                    Refusal{"limit 5000000000", "'5000000000'", "4294967295"},
                    Refusal{"slot 2ms 1ms", "'1ms' is shorter", "2000000ns"},
                    Refusal{"slot distribution normal", "'distribution' is not a valid shortest slot", "50ms"},
                    Refusal{"slot 1ms packets", "the line ends", "packets of slot"},
                    Refusal{"slot 1ms packets -3", "'-3' is not a valid packets of slot", "from 0"}));

TEST(NetemWarnings, NameGemodelAndTheRealLossWhenLossIsCorrelated) {
  EXPECT_THAT(netem_warnings(parse_netem("loss 10% 25%")),
              ElementsAre(AllOf(HasSubstr("loss 10% with correlation 25%"), HasSubstr("about 1.7%"),
                                HasSubstr("'loss gemodel'"))));
}

TEST(NetemWarnings, AreEmptyForUsualSettings) {
  EXPECT_THAT(netem_warnings(parse_netem("delay 50ms 10ms 25% loss 5% duplicate 1% 5%")), IsEmpty());
  EXPECT_THAT(netem_warnings(parse_netem("loss gemodel 1% 10%")), IsEmpty());
  EXPECT_THAT(netem_warnings({}), IsEmpty());
}

}  // namespace
}  // namespace forcebound::netem
