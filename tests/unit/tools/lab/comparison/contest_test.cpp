#include "tests/tools/lab/comparison/contest.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/tools/lab/comparison/trial.hpp"

namespace forcebound::lab {
namespace {

Contest wall(Conditions conditions) {
  return {.task = task_of("wall"),
          .stiffness_N_per_m = 10e3,
          .network = network_of("none"),
          .conditions = conditions,
          .law = "none"};
}

TEST(Contest, KnowsThePapersScenes) {
  EXPECT_EQ(task_of("sphere").device, "cartesian-3dof");
  EXPECT_EQ(task_of("sphere", "omni").device, "omni");
  try {
    (void)task_of("spere");
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "unknown scene 'spere', did you mean 'sphere'? (known: wall, circle, sphere)");
  }
}

TEST(Contest, DoesTheSameToBothWays) {
  const NamedNetwork network = network_of("delay 10ms loss 5%");
  EXPECT_EQ(network.settings.up, network.settings.down);
  EXPECT_EQ(network.settings.up.delay.mean, time::from_seconds(10e-3));
  EXPECT_THROW((void)network_of("dealy 10ms"), std::invalid_argument);
  EXPECT_THROW((void)network_of("trace:/nowhere.csv"), std::runtime_error);
}

TEST(Contest, HasAnIdealDeviceAndARealOne) {
  const auto ideal = settings_of(wall(Conditions::ideal));
  EXPECT_TRUE(ideal.device.facts.encoder_step.isZero(0));
  EXPECT_EQ(ideal.device.facts.latency_s, 0);
  EXPECT_FALSE(ideal.timing.measured);
  const auto real = settings_of(wall(Conditions::real));
  EXPECT_EQ(real.device.facts.encoder_step[0], 15e-6);
  EXPECT_GT(real.device.facts.latency_s, 0);
  EXPECT_TRUE(real.timing.measured);
}

TEST(Trial, ShowsASoftWallAsItIs) {
  const Trial trial = play(wall(Conditions::ideal));
  EXPECT_NEAR(trial.shown_N_per_m, 10e3, 10);
  EXPECT_TRUE(trial.calm);
  EXPECT_EQ(trial.drift_m, 0);
  // Without any delay, encoder and law the force is the reference's own.
  EXPECT_NEAR(trial.error, 0, 1e-9);
  EXPECT_NEAR(trial.restlessness, 0, 1e-6);
}

TEST(Trial, SeesWhatHappensWithoutALawBehindADelay) {
  Contest contest = wall(Conditions::ideal);
  contest.network = network_of("delay 50ms");
  const Trial trial = play(contest);
  EXPECT_LT(trial.passivity_minimum_J, -1);
  EXPECT_FALSE(trial.calm);
  EXPECT_GT(trial.restlessness, 0.5);
  EXPECT_GT(trial.error, 0.5);
  contest.law = "fba-exact";
  EXPECT_GE(play(contest).passivity_minimum_J, -1e-9);
}

TEST(Trial, SeesAToolBesideTheDeviceEvenWithoutDelay) {
  Contest contest = wall(Conditions::ideal);
  contest.law = "vc";
  const Trial trial = play(contest);
  // The coupling is stretched by its force.
  EXPECT_GT(trial.drift_m, 1e-4);
  EXPECT_LT(trial.drift_m, 2e-3);
}

TEST(Trial, TakesBlackoutForNoRest) {
  Contest contest = wall(Conditions::ideal);
  contest.law = "fba-more";
  contest.network = network_of("loss 100%");
  const Trial trial = play(contest);
  EXPECT_FALSE(trial.calm);
  EXPECT_EQ(trial.shown_N_per_m, 0);
}

TEST(Trial, IsTheSameForTheSameSeed) {
  Contest contest = wall(Conditions::real);
  contest.network = network_of("delay 10ms 5ms loss 10%");
  contest.law = "fba-less";
  const Trial first = play(contest);
  EXPECT_EQ(play(contest).error, first.error);
  contest.seed = 2;
  EXPECT_NE(play(contest).error, first.error);
}

}  // namespace
}  // namespace forcebound::lab
