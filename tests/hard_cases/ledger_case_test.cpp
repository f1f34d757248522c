// Case 5: a ledger of very many ticks. Built twice: for the usual run, and for the long one with 1e9 ticks.

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "forcebound/control/exact_law.hpp"
#include "forcebound/control/less_conservative_law.hpp"
#include "tests/support/ideal_device.hpp"

namespace forcebound::control {
namespace {

using test::kDamping_N_s_per_m;
using test::kPeriod_s;

DeviceFacts ledger_facts() {
  DeviceFacts facts;
  facts.name = "ledger";
  facts.period_s = facts.hold_s_max = kPeriod_s;
  facts.damping = kDamping_N_s_per_m * Matrix::Identity(1, 1);
  facts.friction = facts.encoder_step = Vector::Zero(1);
  facts.force_N_max = 1;
  return facts;
}

/// Trembles within a micrometre under a force that is bounded now and then, and is saved and resumed half-way.
template <typename Law>
void expect_exact_ledger(Law law) {
  constexpr std::size_t kPlaces = 4096;
  std::mt19937_64 random(5);
  std::array<double, kPlaces> places{};
  std::array<double, kPlaces> requests{};
  for (std::size_t i = 0; i < kPlaces; ++i) {
    places[i] = 1e-6 * static_cast<double>(random() % 1000) / 1000;
    requests[i] = static_cast<double>(random() % 1000) / 500 - 1;
  }
  const Damping damping = Damping::from_matrix(ledger_facts().damping);
  Motion motion{.interval_s = kPeriod_s,
                .position = Vector::Zero(1),
                .joint = Vector::Zero(1),
                .jacobian = Matrix::Identity(1, 1),
                .damping = &damping};
  Vector request = Vector::Zero(1);
  law.credit(motion);

  long double expected_J = 0;
  double force_N = 0;
  double before_m = 0;
  constexpr std::uint64_t kTicks = FORCEBOUND_LEDGER_TICKS;
  for (std::uint64_t n = 1; n <= kTicks; ++n) {
    if (n == kTicks / 2) law = Law(law);
    const std::size_t at = (n * 2654435761U) % kPlaces;
    const double d = places[at] - before_m;
    before_m = places[at];
    expected_J +=
        static_cast<long double>(d) * kDamping_N_s_per_m / kPeriod_s * d - static_cast<long double>(force_N) * d;
    motion.position[0] = motion.joint[0] = before_m;
    law.credit(motion);
    request[0] = requests[at];
    const Vector force = law.bound(request);
    law.commit(force);
    force_N = force[0];
  }
  EXPECT_GT(static_cast<double>(expected_J), 1e-9 * static_cast<double>(kTicks)) << "no energy was added up";
  EXPECT_NEAR(law.energy_J(), static_cast<double>(expected_J), 1e-9);
}

TEST(HardCase05, LedgerOfTheLessConservativeLawIsExactAfterManyTicks) {
  expect_exact_ledger(LessConservativeLaw(1, kPeriod_s));
}

TEST(HardCase05, LedgerOfTheExactLawIsExactAfterManyTicks) {
  expect_exact_ledger(ExactLaw(ledger_facts(), EnergyMemory::full));
}

}  // namespace
}  // namespace forcebound::control
