#include <gtest/gtest.h>

#include <sstream>

#include "tests/unit/tools/netem/impairment_harness.hpp"

namespace forcebound::netem {
namespace {

using namespace std::chrono_literals;
using testing_support::Way;

constexpr const char* kEverything =
    "delay 20ms 10ms 20% distribution paretonormal loss gemodel 2% 20% 90% 0.1% duplicate 5% 10% corrupt 3% 5% "
    "reorder 10% 30% gap 3 rate 2Mbit 10 48 5 limit 40 slot 1ms 3ms packets 4 bytes 2000";

/// All verdicts and all departures, as text.
std::string trace(const ImpairmentSettings& settings, int packets = 20'000) {
  Way way(settings);
  std::ostringstream text;
  const auto write = [&](const Verdict& verdict) {
    text << verdict.number << ',' << verdict_text(verdict) << ',' << verdict.delay.count() << '\n';
  };
  for (int i = 0; i < packets; ++i) {
    const std::string payload(static_cast<std::size_t>(i % 97), static_cast<char>('a' + i % 26));
    for (const Verdict& verdict : way.send(i * 1ms, payload)) write(verdict);
  }
  for (const auto& left : way.finish()) {
    write(left.verdict);
    text << left.bytes << '\n';
  }
  return text.str();
}

std::uint64_t fnv1a(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return hash;
}

TEST(ImpairmentReplay, OneSeedGivesOneTraceByteForByte) {
  const ImpairmentSettings settings{.netem = parse_netem(kEverything), .seed = 12345};
  EXPECT_EQ(trace(settings), trace(settings));
}

TEST(ImpairmentReplay, AnotherSeedGivesAnotherTrace) {
  const NetemParameters netem = parse_netem(kEverything);
  EXPECT_NE(trace({.netem = netem, .seed = 1}, 1000), trace({.netem = netem, .seed = 2}, 1000));
}

// The constants were computed once; on any other machine or compiler they must be the same.
TEST(ImpairmentReplay, TraceIsTheSameOnEveryMachine) {
  EXPECT_EQ(fnv1a(trace({.netem = parse_netem("delay 50ms 10ms loss 5%"), .seed = 1})), 1434166428611695698U);
  EXPECT_EQ(fnv1a(trace({.netem = parse_netem(kEverything), .seed = 12345})), 2049370242902378468U);
  EXPECT_EQ(fnv1a(trace({.netem = parse_netem("delay 50ms 10ms distribution normal loss state 2% 10% 20% 50% 1%"),
                         .seed = 99})),
            3165706046382272739U);
}

TEST(ImpairmentReplay, HowOftenItIsAskedChangesNothing) {
  const NetemParameters netem = parse_netem(kEverything);
  Impairment eager({.netem = netem, .seed = 5});
  Impairment lazy({.netem = netem, .seed = 5});
  std::vector<Verdict> from_eager;
  std::vector<Verdict> from_lazy;
  const auto pop_all = [](Impairment& impairment, Nanoseconds now, std::vector<Verdict>& left) {
    while (const auto departure = impairment.pop(now)) left.push_back(departure->verdict);
  };
  for (int i = 0; i < 5000; ++i) {
    for (int part = 0; part < 10; ++part) pop_all(eager, i * 1ms + part * 100us, from_eager);
    eager.push(i * 1ms + 900us, {});
    pop_all(lazy, i * 1ms + 900us, from_lazy);
    lazy.push(i * 1ms + 900us, {});
  }
  pop_all(eager, 1h, from_eager);
  pop_all(lazy, 1h, from_lazy);
  EXPECT_EQ(from_eager, from_lazy);
}

TEST(ImpairmentReplay, TheSameChangesAtTheSameTimesGiveTheSameFates) {
  const auto fates = [](const ImpairmentSettings& settings) {
    Way way(settings);
    std::string text;
    for (int i = 0; i < 2000; ++i) {
      if (i == 500) way.impairment().change(i * 1ms, parse_netem(kEverything));
      if (i == 1500) way.impairment().change(i * 1ms, {});
      for (const Verdict& verdict : way.send(i * 1ms)) text += verdict_text(verdict) + ' ';
    }
    return text;
  };
  const ImpairmentSettings settings{.netem = parse_netem("loss 50%"), .seed = 7};
  EXPECT_EQ(fates(settings), fates(settings));
  EXPECT_NE(fates(settings), fates({.netem = parse_netem("loss 50%"), .seed = 8}));
}

TEST(ImpairmentReplay, DirectionsOfOneSeedAreIndependent) {
  EXPECT_NE(direction_seed(1, Direction::up), direction_seed(1, Direction::down));
  EXPECT_NE(direction_seed(1, Direction::down), direction_seed(2, Direction::up));
  const NetemParameters netem = parse_netem("loss 50%");
  Way up({.netem = netem, .seed = direction_seed(1, Direction::up)});
  Way down({.netem = netem, .seed = direction_seed(1, Direction::down)});
  int same = 0;
  for (int i = 0; i < 10'000; ++i) same += up.send(i * 1ms).begin()->fate == down.send(i * 1ms).begin()->fate ? 1 : 0;
  EXPECT_NEAR(same, 5'000, 250);
}

TEST(ImpairmentReplay, VerdictsReadAsWords) {
  EXPECT_EQ(verdict_text({}), "forwarded");
  EXPECT_EQ(verdict_text({.fate = Fate::lost}), "lost");
  EXPECT_EQ(verdict_text({.fate = Fate::over_limit}), "over-limit");
  EXPECT_EQ(verdict_text({.fate = Fate::blackout}), "blackout");
  EXPECT_EQ(verdict_text({.copy = true, .corrupted = true, .reordered = true}),
            "duplicate+corrupted+reordered+forwarded");
}

}  // namespace
}  // namespace forcebound::netem
