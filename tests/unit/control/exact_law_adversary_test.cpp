// fba-exact against an opponent that plays hand, environment, clock and transport at once, and knows the true position.

#include <gtest/gtest.h>

#include <algorithm>

#include "forcebound/control/exact_law.hpp"
#include "forcebound/control/less_conservative_law.hpp"
#include "tests/support/drawn_games.hpp"
#include "tests/tools/reference/kinematic_adversary.hpp"

namespace forcebound::control {
namespace {

using test::KinematicGame;

constexpr double kRounding_J = 1e-12;

TEST(ExactLaw, IsPassiveAgainstAnyHandEnvironmentClockAndTransport) {
  long double worst_of_published_J = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    const KinematicGame drawn = test::game_of_exact_facts(seed);
    ExactLaw law(drawn.facts, seed % 2 == 0 ? EnergyMemory::full : EnergyMemory::capped);
    ASSERT_GE(static_cast<double>(least_P_J(law, drawn)), -kRounding_J);

    if (drawn.turning) continue;  // published laws know no joints
    LessConservativeLaw published(static_cast<int>(drawn.facts.damping.rows()), drawn.facts.period_s);
    worst_of_published_J = std::min(worst_of_published_J, least_P_J(published, drawn));
  }
  EXPECT_LT(static_cast<double>(worst_of_published_J), -0.1) << "the opponent is too weak to prove anything";
}

TEST(ExactLaw, IsPassiveForEveryTruthWithinTheFactsBrackets) {
  long double worst_of_exact_facts_J = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    KinematicGame drawn = test::game_of_exact_facts(seed);
    drawn.truth = test::truth_beyond_facts(seed);
    drawn.ticks = 1000;
    ExactLaw believer(drawn.facts);
    worst_of_exact_facts_J = std::min(worst_of_exact_facts_J, least_P_J(believer, drawn));

    drawn.facts.uncertainty = uncertainty_of(drawn.truth, drawn.facts);
    ExactLaw law(drawn.facts, seed % 2 == 0 ? EnergyMemory::full : EnergyMemory::capped);
    ASSERT_GE(static_cast<double>(least_P_J(law, drawn)), -kRounding_J);
  }
  EXPECT_LT(static_cast<double>(worst_of_exact_facts_J), -0.1) << "the opponent is too weak to prove anything";
}

/// Receives 1 mJ with each tick.
class Richer final : public PassivityLaw {
 public:
  explicit Richer(const DeviceFacts& facts) : law_(facts, EnergyMemory::full) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "richer"; }
  void credit(const Motion& motion) noexcept override {
    law_.receive_energy(1e-3);
    law_.credit(motion);
  }
  void lose(const Motion& motion) noexcept override { law_.lose(motion); }
  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override { return law_.bound(request_N); }
  [[nodiscard]] bool allows(const Vector& force_N, double latency_s) const noexcept override {
    return law_.allows(force_N, latency_s);
  }
  void commit(const Vector& force_N) noexcept override { law_.commit(force_N); }
  [[nodiscard]] double energy_J() const noexcept override { return law_.energy_J(); }

 private:
  ExactLaw law_;
};

TEST(ExactLaw, SpendsWhatItReceivesAndNeverWhatItGave) {
  // The other end of the same account: P plus the received less the given, against the same opponent.
  double given_J = 0;
  double least_of_all_J = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    KinematicGame drawn = test::game_of_exact_facts(seed);
    drawn.received_J_per_tick = seed % 3 == 0 ? 0 : 1e-3;
    drawn.ticks = 1000;
    ExactLaw law(drawn.facts, seed % 4 == 0 ? EnergyMemory::full : EnergyMemory::capped);
    ASSERT_GE(static_cast<double>(least_P_J(law, drawn)), -1e-11);
    given_J += law.energy_given_J();

    if (drawn.received_J_per_tick == 0) continue;
    drawn.received_J_per_tick = 0;  // P alone
    Richer richer(drawn.facts);
    const auto least_J = static_cast<double>(least_P_J(richer, drawn));
    ASSERT_GE(least_J, -1e-3 * drawn.ticks - 1e-11) << "it spent more than it received";
    least_of_all_J = std::min(least_of_all_J, least_J);
  }
  EXPECT_GT(given_J, 0.1);
  EXPECT_LT(least_of_all_J, -0.1) << "what was received was not spent";
}

/// Of device A: 30 N s/m, 15 um.
KinematicGame device_a(double latency_s) {
  KinematicGame game{.seed = 1};
  game.facts.name = "a";
  game.facts.damping = Matrix::Constant(1, 1, 30);
  game.facts.friction = Vector::Zero(1);
  game.facts.encoder_step = Vector::Constant(1, 15e-6);
  game.facts.force_N_max = 30;
  game.facts.latency_s = latency_s;
  return game;
}

TEST(ExactLaw, IsPassiveBehindALatencyWhereIntervalsAreImpossible) {
  for (const double latency_s : {0.0, 100e-6, 300e-6, 1e-3, 2.5e-3}) {
    SCOPED_TRACE(latency_s);
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      KinematicGame game = device_a(latency_s);
      game.seed = seed;
      game.truth.impossible_intervals = 0.25;
      ExactLaw law(game.facts);
      ASSERT_GE(static_cast<double>(least_P_J(law, game)), -kRounding_J);
    }
  }
}

TEST(ExactLaw, IsPassiveWhereMoreForcesWaitThanItCanTellApart) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    KinematicGame game = device_a(8e-3);
    game.seed = seed;
    game.late_ticks = true;
    game.facts.period_s = 1e-3;
    ExactLaw law(game.facts);
    game.facts.period_s = 0.2e-3;  // of the ticks as they come: forty wait
    ASSERT_GE(static_cast<double>(least_P_J(law, game)), -kRounding_J);
  }
}

}  // namespace
}  // namespace forcebound::control
