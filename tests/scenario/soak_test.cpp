#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <string>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/law_registry.hpp"
#include "tests/tools/lab/passivity.hpp"
#include "tests/tools/lab/soak/soak.hpp"
#include "tests/tools/lab/soak/soak_case.hpp"

// Passive no matter how late the force arrives: hostile runs from seeds, checked on every tick, and the published laws
// as the control group, which shows that the runs are hostile enough.
//
//   restless hand -- device -- client session ==( drawn network )== hostile environment -- server -- wall
namespace forcebound::lab {
namespace {

class Soak : public testing::TestWithParam<int> {};

/// The first part always has the same seeds; the others have those of the commit, by which deploy/test names them.
std::uint64_t first_seed(int part, int seeds) {
  const auto first = static_cast<std::uint64_t>(part * seeds + 1);
  const char* const from = std::getenv("FORCEBOUND_SOAK_FROM");
  return part == 0 || from == nullptr ? first : first + std::strtoull(from, nullptr, 10);
}

TEST_P(Soak, FindsNoViolationOfTheExactLaw) {
  constexpr int kSeeds = FORCEBOUND_SOAK_SEEDS / 6;
  const std::uint64_t first = first_seed(GetParam(), kSeeds);
  for (std::uint64_t seed = first; seed < first + kSeeds; ++seed) {
    const SoakResult result = soak(seed, "fba-exact");
    ASSERT_EQ(result.broken, "") << "again: forcebound-lab soak --law fba-exact --seeds 1 --from " << seed;
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, Soak, testing::Range(0, 6));

TEST(Soak, LeaksWithEachPublishedLawFromTheSameSeeds) {
  for (const char* law : {"fba-less", "fba-more"}) {
    double worst_J = 0;
    for (std::uint64_t seed = 71; seed <= 100; ++seed) {
      const SoakResult result = soak(seed, law);
      EXPECT_EQ(result.broken, "") << law << " from seed " << seed << ": all invariants but P >= 0 hold for it, too";
      worst_J = std::min(worst_J, result.least_P_J);
    }
    EXPECT_LT(worst_J, -0.1) << law;
  }
}

TEST(Soak, DrawsEveryLaw) {
  std::set<std::string> drawn;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) drawn.insert(law_of(seed));
  EXPECT_EQ(drawn.size(), baselines::shipped_laws().names().size());
}

TEST(Soak, DrawsServersThatLieInAllTheyHandOverOrTakeTheirTime) {
  std::set<std::string> handed_over;
  std::set<time::Nanoseconds> turns;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const SoakCase drawn = draw_soak_case(seed, "fba-exact");
    if (drawn.settings.handed_over) handed_over.insert(drawn.settings.handed_over->facts().name);
    turns.insert(drawn.settings.server_turn);
  }
  EXPECT_EQ(handed_over, (std::set<std::string>{"lie", "sheet"})) << "a sheet comes in many pieces";
  EXPECT_EQ(turns.size(), 4U) << "none, and three lengths";
}

class SoakOfLaw : public testing::TestWithParam<std::string> {};

TEST_P(SoakOfLaw, FindsItsGuaranteesKept) {
  const std::string& law = GetParam();
  int promised = 0;
  for (std::uint64_t seed = 1; seed <= std::max(6, FORCEBOUND_SOAK_SEEDS / 30); ++seed) {
    const SoakResult result = soak(seed, law);
    ASSERT_EQ(result.broken, "") << "again: forcebound-lab soak --law " << law << " --seeds 1 --from " << seed;
    promised += result.passive ? 1 : 0;
  }
  EXPECT_EQ(promised > 0, baselines::shipped_laws().find(law).claim != control::LawClaim::nothing);
}
INSTANTIATE_TEST_SUITE_P(Laws, SoakOfLaw, testing::ValuesIn(baselines::shipped_laws().names()), [](const auto& law) {
  std::string name = law.param;
  std::erase(name, '-');
  return name;
});

TEST(Soak, MeetsLateTicksAndLedgersThatCanBeRecomputed) {
  std::uint64_t recomputed = 0;
  std::uint64_t late = 0;
  for (std::uint64_t seed = 1; seed <= 40 && (recomputed == 0 || late == 0); ++seed) {
    const SoakResult result = soak(seed, "fba-exact");
    recomputed += result.recomputed;
    late += result.late_ticks;
  }
  EXPECT_GT(recomputed, 0U);
  EXPECT_GT(late, 0U);
}

// A Hello every two seconds needs twenty of them to outlast a burst of ten datagrams each way.
TEST(Soak, DoesNotReportAHandshakeLostInABurst) { EXPECT_EQ(soak(558, "fba-less").broken, ""); }

// The law or the hand throws the device hundreds of metres behind the wall, and the server's depth is as large.
TEST(Soak, KeepsTheSessionOfADeviceThatIsThrownFarBehindTheWall) {
  EXPECT_EQ(soak(771000769, "fba-exact").broken, "");
  EXPECT_EQ(soak(100003126, "tdpa").broken, "");
  EXPECT_EQ(soak(555003210, "tdpa").broken, "");
  EXPECT_EQ(soak(555000628, "none").broken, "");
}

// A way up of 200 +- 100 ms (Pareto): the last motion of all comes 250 ms after all others have come.
TEST(Soak, CountsNoMotionAsLostThatComesAfterAllOthers) {
  EXPECT_EQ(soak(882000141, "aol").broken, "");
  EXPECT_EQ(soak(555000734, "eba").broken, "");
  EXPECT_EQ(soak(555001011, "vc").broken, "");
  // Late ticks: motions are sent every 4 ms, so that one that is behind by ten came 40 ms late.
  EXPECT_EQ(soak(910004530, "fba-exact").broken, "");
}

TEST(Soak, GivesOneRunForOneSeed) {
  for (const std::uint64_t seed : {7U, 8U, 9U}) {
    const SoakResult once = soak(seed, "fba-exact");
    const SoakResult again = soak(seed, "fba-exact");
    EXPECT_EQ(once.digest, again.digest) << seed;
    EXPECT_NE(once.digest, soak(seed + 100, "fba-exact").digest);
  }
}

double leak_J(const PassivityCondition& condition) {
  return -worst_passivity(condition, {.seeds = 1, .duration_s = 2}).least_P_J;
}

TEST(PublishedLaws, LeakMillijoulesThroughEncodersAndFarMoreThroughLatencyOrLateTicks) {
  for (const char* law : {"fba-less", "fba-more"}) {
    SCOPED_TRACE(law);
    EXPECT_LT(leak_J({law, 0, false, 0, "bang-bang"}), 1e-9) << "as proved, on an ideal device";
    EXPECT_GT(leak_J({law, 15e-6, false, 0, "bang-bang"}), 1e-3);
    EXPECT_GT(leak_J({law, 55e-6, false, 0, "bang-bang"}), 10e-3);
    EXPECT_GT(leak_J({law, 0, false, 300e-6, "bang-bang"}), 10e-3);
    EXPECT_GT(leak_J({law, 0, true, 0, "bang-bang"}), 0.1);
  }
}

TEST(ExactLaw, LeaksNothingWhereThePublishedLawsDo) {
  for (const char* adversary : {"bang-bang", "switching", "greedy", "random"}) {
    SCOPED_TRACE(adversary);
    for (const double encoder_m : {0.0, 15e-6, 55e-6}) {
      for (const double latency_s : {0.0, 300e-6}) {
        EXPECT_LT(leak_J({"fba-exact", encoder_m, true, latency_s, adversary}), 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace forcebound::lab
