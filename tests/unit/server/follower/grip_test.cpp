#include "forcebound/server/follower/grip.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <random>

namespace forcebound::server {
namespace {

TEST(Grip, MovesOnceItIsMetFromEitherSide) {
  for (const bool from_above : {true, false}) {
    Grip grip;
    grip.begin(0.5);
    const auto seen = [&](double way) { return 0.5 + (from_above ? way : -way); };
    EXPECT_EQ(grip.follow(seen(0.4)), std::nullopt);
    EXPECT_EQ(grip.follow(seen(0.1)), std::nullopt);
    EXPECT_TRUE(grip.waits());
    EXPECT_EQ(grip.follow(seen(-0.1)), seen(-0.1)) << "passed";
    EXPECT_FALSE(grip.waits());
    EXPECT_EQ(grip.follow(seen(0.4)), seen(0.4)) << "from then on it follows";
  }
}

TEST(Grip, MeetsWithoutAStepWhatItComesCloseTo) {
  Grip grip;
  grip.begin(0.3);
  EXPECT_EQ(grip.follow(0.34), 0.3);
  EXPECT_EQ(grip.follow(0.34), 0.3) << "a grip that is kept still keeps the gripper still";
  EXPECT_NEAR(*grip.follow(0.32), 0.29, 1e-12);
  EXPECT_NEAR(*grip.follow(0.20), 0.20, 1e-12) << "the rest of the way has ended";
}

TEST(Grip, NeverMovesFartherThanTheOperatorsGripDoesByHalfAsMuchAgain) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(0, 1);
  for (int run = 0; run < 1000; ++run) {
    Grip grip;
    const double stands = any(random);
    grip.begin(stands);
    double before = any(random);
    double commanded = stands;
    (void)grip.follow(before);
    for (int tick = 0; tick < 200; ++tick) {
      const double wanted = std::clamp(before + 0.1 * (any(random) - 0.5), 0.0, 1.0);
      const double now = grip.follow(wanted).value_or(commanded);
      ASSERT_LE(std::abs(now - commanded), 1.5 * std::abs(wanted - before) + 1e-12) << "run " << run;
      before = wanted;
      commanded = now;
    }
  }
}

TEST(Grip, ThatWasCommandedStandsWhereItWasCommandedNotWhereWhatItHoldsKeepsIt) {
  Grip grip;
  grip.begin(1);
  EXPECT_EQ(grip.follow(1), 1);
  EXPECT_EQ(grip.follow(0), 0);
  EXPECT_TRUE(grip.holds(0.3));
  EXPECT_FALSE(grip.holds(0));
  grip.begin(0.3);
  EXPECT_EQ(grip.follow(0.3), std::nullopt) << "it would squeeze no more";
  EXPECT_EQ(grip.follow(0), 0);
}

TEST(Grip, IgnoresWhatNoGripCanBe) {
  Grip grip;
  grip.begin(0.5);
  EXPECT_EQ(grip.follow(std::numeric_limits<double>::quiet_NaN()), std::nullopt);
  EXPECT_EQ(grip.follow(7), std::nullopt);
  Grip none;
  none.begin(std::nullopt);
  EXPECT_EQ(none.follow(0.7), 0.7) << "of a robot that does not tell of its gripper";
}

}  // namespace
}  // namespace forcebound::server
