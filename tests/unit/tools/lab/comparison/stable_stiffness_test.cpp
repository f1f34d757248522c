#include "tests/tools/lab/comparison/stable_stiffness.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace forcebound::lab {
namespace {

TEST(LargestStable, FindsALimitToItsResolution) {
  const auto found = largest_stable({}, [](double stiffness) { return stiffness <= 12'345; });
  EXPECT_FALSE(found.no_limit);
  EXPECT_LE(found.N_per_m, 12'345);
  EXPECT_GE(found.N_per_m, 12'345 / 1.02);
}

TEST(LargestStable, SaysThatThereIsNoLimitWhereAllAreStable) {
  const auto found = largest_stable({}, [](double) { return true; });
  EXPECT_TRUE(found.no_limit);
  EXPECT_EQ(found.N_per_m, StiffnessSearch{}.most_N_per_m);
}

TEST(LargestStable, IsZeroWhereNotEvenTheLeastIsStable) {
  EXPECT_EQ(largest_stable({}, [](double) { return false; }).N_per_m, 0);
}

TEST(LargestStable, DoesNotJumpOverAnUnstableRange) {
  const auto found = largest_stable({}, [](double stiffness) { return stiffness < 1e3 || stiffness > 1e5; });
  EXPECT_NEAR(found.N_per_m, 1e3, 20);
}

TEST(TheoryLimits, AreThoseOfThePapersDevice) {
  const TheoryLimits near = theory_limits("wall-1dof", 0);
  EXPECT_DOUBLE_EQ(near.passive_N_per_m, 60e3);
  EXPECT_DOUBLE_EQ(near.delayed_N_per_m, 60e3);
  EXPECT_NEAR(near.free_N_per_m, 63.15e3, 10);
  EXPECT_NEAR(theory_limits("wall-1dof", 10e-3).delayed_N_per_m, 30 / 0.0205, 1e-9);
}

TEST(TheoryLimits, FollowTheRateOfTheLoop) {
  EXPECT_DOUBLE_EQ(theory_limits("wall-1dof", 0, 4000).passive_N_per_m, 240e3);
  EXPECT_DOUBLE_EQ(theory_limits("wall-1dof", 50e-6, 500).delayed_N_per_m, 30 / 1.1e-3);
  EXPECT_DOUBLE_EQ(theory_limits("cartesian-3dof", 0, 2000).passive_N_per_m, 2e3);
}

TEST(TheoryLimits, RefuseAnArm) { EXPECT_THROW((void)theory_limits("omni", 0), std::invalid_argument); }

TEST(FreeDevice, LosesStabilityAtTheFormulaWithinOnePercent) {
  const double limit = theory_limits("wall-1dof", 0).free_N_per_m;
  EXPECT_TRUE(free_device_is_stable("wall-1dof", 0.99 * limit));
  EXPECT_FALSE(free_device_is_stable("wall-1dof", 1.01 * limit));
}

TEST(PressedWall, IsNeverUnstableWithinTheTheorysLimit) {
  for (const double delay_s : {0.0, 1e-3, 10e-3}) {
    const double promised = theory_limits("wall-1dof", delay_s).delayed_N_per_m;
    for (const PressingHand& hand : pressing_hands()) {
      EXPECT_TRUE(is_stable({.law = "none", .hand = hand.specification, .delay_s = delay_s}, 0.99 * promised))
          << hand.name << " " << delay_s;
    }
  }
}

TEST(PressedWall, IsStableUpToTheLimitOfEachRate) {
  for (const double rate_Hz : {500.0, 2000.0, 4000.0}) {
    const double promised = theory_limits("wall-1dof", 0, rate_Hz).passive_N_per_m;
    const PressingHand& hand = pressing_hands().back();
    EXPECT_TRUE(is_stable({.law = "none", .hand = hand.specification, .rate_Hz = rate_Hz}, 0.99 * promised)) << rate_Hz;
    EXPECT_FALSE(is_stable({.law = "none", .hand = hand.specification, .rate_Hz = rate_Hz}, 3 * promised)) << rate_Hz;
  }
}

TEST(PressedWall, RingsWithoutALawFarAboveTheory) {
  for (const PressingHand& hand : pressing_hands()) {
    EXPECT_FALSE(is_stable({.law = "none", .hand = hand.specification}, 150e3)) << hand.name;
  }
}

}  // namespace
}  // namespace forcebound::lab
