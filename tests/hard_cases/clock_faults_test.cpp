// fba-exact where readings are lost and the clock says what cannot be, on facts of every kind: neither P nor, on any
// tick, what the law believes is there to spend may be wrong. Built twice: for the usual run, and for the long one.

#include <gtest/gtest.h>

#include <algorithm>

#include "forcebound/control/exact_law.hpp"
#include "tests/support/drawn_games.hpp"

namespace forcebound::control {
namespace {

TEST(ClockFaults, LeaveTheExactLawNoMoreThanThereIsWhateverReadingsAreLost) {
  constexpr int kTicksOfARun = 1000;
  constexpr long double kRounding = 1e-11L;
  long ticks = 0;
  for (std::uint64_t seed = 1; ticks < FORCEBOUND_CLOCK_FAULT_TICKS; ++seed, ticks += kTicksOfARun) {
    SCOPED_TRACE(seed);
    test::KinematicGame game = test::game_of_exact_facts(seed);
    if (seed % 2 == 0) {
      game.truth = test::truth_beyond_facts(seed);
      game.facts.uncertainty = test::uncertainty_of(game.truth, game.facts);
    }
    game.ticks = kTicksOfARun;
    game.truth.lost_readings = seed % 3 == 0 ? 0.5 : 0.1;
    game.truth.impossible_intervals = seed % 5 == 0 ? 0.3 : 0.03;
    ExactLaw law(game.facts, seed % 4 < 2 ? EnergyMemory::full : EnergyMemory::capped);
    const test::KinematicOutcome outcome = test::play(law, game);
    ASSERT_GE(static_cast<double>(outcome.least_P_J), -1e-12);
    const long double most_J = std::max(1.0L, static_cast<long double>(law.energy_J()) + law.energy_given_J());
    ASSERT_GE(static_cast<double>(outcome.least_surplus_J), static_cast<double>(-kRounding * most_J));
  }
}

}  // namespace
}  // namespace forcebound::control
