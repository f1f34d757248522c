#include "forcebound/control/ledger.hpp"

#include <gtest/gtest.h>

#include "tests/support/ideal_device.hpp"
#include "tests/support/law_loop.hpp"
#include "tests/support/special_numbers.hpp"

namespace forcebound::control {
namespace {

using test::kInfinity;
using test::kNaN;
using test::kPeriod_s;
using test::to_matrix;
using test::to_vector;

class LedgerTest : public testing::Test {
 protected:
  void credit(const std::vector<double>& position_m, const Damping& damping) {
    Motion motion;
    motion.interval_s = kPeriod_s;
    motion.position = to_vector(position_m);
    motion.damping = &damping;
    ledger_.credit(motion);
  }
  void credit(const std::vector<double>& position_m) { credit(position_m, damping_); }

  Damping damping_ = Damping::from_matrix(to_matrix({{4, 2}, {2, 10}}));
  Ledger ledger_{2, kPeriod_s};
};

TEST_F(LedgerTest, BeginsAtZeroWhereverTheDeviceIs) {
  credit({5, -3});
  EXPECT_EQ(ledger_.energy_J(), 0.0);
}

TEST_F(LedgerTest, SavesWhatFreeMotionDissipates) {
  // d'b d / T = 18e-6 / 1e-3 for every step of (1, 1) mm
  for (int i = 0; i <= 1000; ++i) credit({i * 1e-3, i * 1e-3});
  EXPECT_NEAR(ledger_.energy_J(), 18.0, 1e-11);
}

TEST_F(LedgerTest, ChargesTheWorkOfTheForceHeld) {
  credit({0, 0});
  ledger_.hold(to_vector({3, -2}));
  credit({1e-3, 2e-3});
  const double dissipated_J = (4 + 2 * 2 * 2 + 10 * 4) * 1e-6 / kPeriod_s;
  EXPECT_NEAR(ledger_.energy_J(), dissipated_J - (3e-3 - 4e-3), 1e-16);
}

TEST_F(LedgerTest, CreditsAnIntervalWithTheDampingAtItsBeginning) {
  const Damping stronger = Damping::from_matrix(to_matrix({{400, 0}, {0, 400}}));
  credit({0, 0});
  credit({1e-3, 1e-3}, stronger);
  EXPECT_NEAR(ledger_.energy_J(), 18e-6 / kPeriod_s, 1e-16);
  credit({2e-3, 1e-3});
  EXPECT_NEAR(ledger_.energy_J(), (18e-6 + 400e-6) / kPeriod_s, 1e-15);
}

TEST_F(LedgerTest, ChargesTheWorstCaseAndCreditsNothingWhereTheDeviceLetGo) {
  credit({0, 0});
  ledger_.hold(to_vector({4, 0}));
  Motion late;
  late.interval_s = 20e-3;
  late.held_s = 2e-3;
  late.position = to_vector({1, 0});
  late.damping = &damping_;
  ledger_.credit(late);
  const double worst_J = 2e-3 * damping_.mobility(to_vector({4, 0})) / 4;
  EXPECT_NEAR(ledger_.energy_J(), -worst_J, 1e-15) << "a metre in one late tick is no fortune";
  credit({1, 1e-3});
  EXPECT_NEAR(ledger_.energy_J(), -worst_J + 10e-6 / kPeriod_s, 1e-15) << "and from there it goes on";
}

TEST_F(LedgerTest, ChargesTheWorstCaseWhereNobodySaw) {
  credit({0, 0});
  credit({1e-3, 1e-3});
  ledger_.hold(to_vector({4, 5}));
  ledger_.lose(2 * kPeriod_s);
  EXPECT_NEAR(ledger_.energy_J(), 18e-6 / kPeriod_s - 2 * kPeriod_s * 5 / 4, 1e-16);
}

TEST_F(LedgerTest, CreditsNothingForAMotionAcrossALoss) {
  credit({0, 0});
  ledger_.lose(kPeriod_s);
  credit({1, 1});
  EXPECT_EQ(ledger_.energy_J(), 0.0);
  credit({1.001, 1.001});
  EXPECT_NEAR(ledger_.energy_J(), 18e-6 / kPeriod_s, 1e-12);
}

TEST_F(LedgerTest, CreditsNothingAndChargesAPeriodForAnIntervalThatNoClockMeasured) {
  credit({0, 0});
  credit({1e-3, 1e-3});
  double expected_J = 18e-6 / kPeriod_s;
  double place_m = 1e-3;
  for (const double interval_s : {0.0, -kPeriod_s, -3600.0, 2e6, 1e308, kInfinity, kNaN}) {
    SCOPED_TRACE(interval_s);
    ledger_.hold(to_vector({0.4, 0.5}));
    Motion motion;
    motion.interval_s = interval_s;
    motion.position = to_vector({place_m += 1, 0});
    motion.damping = &damping_;
    ledger_.credit(motion);
    expected_J -= kPeriod_s * 0.05 / 4;
    EXPECT_NEAR(ledger_.energy_J(), expected_J, 1e-16);
    ledger_.hold(to_vector({0.4, 0.5}));
    ledger_.lose(interval_s);
    expected_J -= kPeriod_s * 0.05 / 4;
    EXPECT_NEAR(ledger_.energy_J(), expected_J, 1e-16);
    credit({place_m, 0});
  }
}

TEST_F(LedgerTest, TakesAReadingBeyondMeasureForAFault) {
  credit({0, 0});
  credit({1e-3, 1e-3});
  ledger_.hold(to_vector({4, 5}));
  credit({1e300, -1e300});
  const double left_J = 18e-6 / kPeriod_s - kPeriod_s * 5 / 4;
  EXPECT_NEAR(ledger_.energy_J(), left_J, 1e-16);
  ledger_.hold(to_vector({0, 0}));
  credit({0, 0});
  credit({1e-3, 1e-3});
  EXPECT_NEAR(ledger_.energy_J(), left_J + 18e-6 / kPeriod_s, 1e-15);
}

}  // namespace
}  // namespace forcebound::control
