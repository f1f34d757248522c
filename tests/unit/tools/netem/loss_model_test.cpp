#include "tests/tools/netem/loss_model.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace forcebound::netem {
namespace {

struct Measured {
  double loss_percent;
  double mean_burst;
};

Measured measure_losses(const char* words, std::uint64_t packets = 1'000'000, std::uint64_t seed = 1) {
  Random random(seed);
  LossModel model(parse_netem(words).loss, random);
  std::uint64_t lost = 0;
  std::uint64_t bursts = 0;
  bool lost_before = false;
  for (std::uint64_t i = 0; i < packets; ++i) {
    const bool is_lost = model.loses_next(random);
    lost += is_lost ? 1U : 0U;
    bursts += is_lost && !lost_before ? 1U : 0U;
    lost_before = is_lost;
  }
  return {100.0 * static_cast<double>(lost) / static_cast<double>(packets),
          bursts == 0 ? 0 : static_cast<double>(lost) / static_cast<double>(bursts)};
}

// Standard deviation of the measured share at 1e6 independent packets and 5 %: 0.022 percentage points.
TEST(LossModel, LosesTheGivenShare) {
  EXPECT_NEAR(measure_losses("loss 5%").loss_percent, 5, 0.1);
  EXPECT_NEAR(measure_losses("loss random 0.1%").loss_percent, 0.1, 0.015);
}

TEST(LossModel, LosesNothingOrEverythingAtTheEnds) {
  EXPECT_EQ(measure_losses("").loss_percent, 0);
  EXPECT_EQ(measure_losses("loss 0%").loss_percent, 0);
  EXPECT_EQ(measure_losses("loss 100%").loss_percent, 100);
}

TEST(LossModel, IndependentLossHasGeometricBursts) {
  EXPECT_NEAR(measure_losses("loss 20%").mean_burst, 1 / 0.8, 0.01);
}

TEST(LossModel, CorrelationPullsLossTowardsTheMiddleAsNetemDoes) {
  EXPECT_NEAR(measure_losses("loss 10% 25%").loss_percent, 1.7, 0.1);
  EXPECT_NEAR(measure_losses("loss 70% 50%").loss_percent, 87, 0.5);
  EXPECT_LT(measure_losses("loss 1% 25%").loss_percent, 0.05);
}

TEST(LossModel, GemodelHasItsMeanLossAndItsMeanBurst) {
  const Measured measured = measure_losses("loss gemodel 1% 10%");
  EXPECT_NEAR(measured.loss_percent, 100.0 / 11, 0.2);
  EXPECT_NEAR(measured.mean_burst, 10.0, 0.25);
}

TEST(LossModel, GemodelLosesInBothStatesByTheirShares) {
  // (P(1-H) + R(1-K)) / (P + R) = (0.02 * 0.5 + 0.08 * 0.1) / 0.1
  EXPECT_NEAR(measure_losses("loss gemodel 2% 8% 50% 10%").loss_percent, 18, 0.3);
}

TEST(LossModel, GemodelDefaultsToLeavingTheBadStateAsOftenAsNotEnteringIt) {
  // R = 1 - P makes the states independent of each other: loss P, bursts of 1 / R.
  const Measured measured = measure_losses("loss gemodel 5%");
  EXPECT_NEAR(measured.loss_percent, 5, 0.1);
  EXPECT_NEAR(measured.mean_burst, 1 / 0.95, 0.01);
}

TEST(LossModel, StateWithDefaultsIsABurstModelOfTwoStates) {
  // 1 -> 3 with P13, 3 -> 1 with P31: P13 / (P13 + P31), bursts of 1 / P31.
  const Measured measured = measure_losses("loss state 1% 10%");
  EXPECT_NEAR(measured.loss_percent, 100.0 / 11, 0.25);
  EXPECT_NEAR(measured.mean_burst, 10.0, 0.25);
}

TEST(LossModel, StateLosesIsolatedPacketsByP14) {
  // With P13 = 0: half of the time of 1 -> 4 -> 1. Loss P14 / (1 + P14), never two in a row.
  const Measured measured = measure_losses("loss state 0% 100% 0% 100% 10%");
  EXPECT_NEAR(measured.loss_percent, 100 * 0.1 / 1.1, 0.1);
  EXPECT_EQ(measured.mean_burst, 1.0);
}

TEST(LossModel, StateGoesInAndOutOfGoodInsideABurst) {
  // Balance of 1, 2, 3: p3 = p1 P13 / P31, p2 = p3 P32 / P23.
  const double p13 = 0.02;
  const double p31 = 0.1;
  const double p32 = 0.2;
  const double p23 = 0.5;
  const double p3 = 1 / (1 + p31 / p13 + p32 / p23);
  EXPECT_NEAR(measure_losses("loss state 2% 10% 20% 50%").loss_percent, 100 * p3, 0.4);
  EXPECT_NEAR(measure_losses("loss state 2% 10% 20% 50%").mean_burst, 1 / (p31 + p32), 0.05);
}

TEST(LossModel, MeasuredLossAgreesWithTheClosedForm) {
  EXPECT_NEAR(100.0 * measured_loss(parse_netem("loss gemodel 1% 10%").loss) / kCertain, 100.0 / 11, 0.2);
}

}  // namespace
}  // namespace forcebound::netem
