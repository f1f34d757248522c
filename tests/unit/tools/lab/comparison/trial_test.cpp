#include "tests/tools/lab/trials/task.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/tools/lab/comparison/trial.hpp"

namespace forcebound::lab {
namespace {

TrialSetup wall(Conditions conditions) {
  return {.task = task_of("wall"),
          .stiffness_N_per_m = 10e3,
          .network = network_of("none"),
          .conditions = conditions,
          .law = "none"};
}

TEST(TrialSetup, KnowsThePapersScenes) {
  EXPECT_EQ(task_of("sphere").device, "cartesian-3dof");
  EXPECT_EQ(task_of("sphere", "omni").device, "omni");
  try {
    (void)task_of("spere");
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "unknown scene 'spere', did you mean 'sphere'? (known: wall, circle, sphere)");
  }
}

TEST(TrialSetup, DoesTheSameToBothWays) {
  const NamedNetwork network = network_of("delay 10ms loss 5%");
  EXPECT_EQ(network.settings.up, network.settings.down);
  EXPECT_EQ(network.settings.up.delay.mean, time::from_seconds(10e-3));
  EXPECT_THROW((void)network_of("dealy 10ms"), std::invalid_argument);
  EXPECT_THROW((void)network_of("trace:/nowhere.csv"), std::runtime_error);
}

TEST(TrialSetup, HasAnIdealDeviceAndARealOne) {
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
  const Trial trial = run_trial(wall(Conditions::ideal));
  EXPECT_NEAR(trial.shown_N_per_m, 10e3, 10);
  EXPECT_TRUE(trial.calm);
  EXPECT_EQ(trial.drift_m, 0);
  // Without any delay, encoder and law the force is the reference's own.
  EXPECT_NEAR(trial.error, 0, 1e-9);
  EXPECT_NEAR(trial.restlessness, 0, 1e-6);
}

TEST(Trial, FindsTheLoopActiveWithoutALawBehindADelay) {
  TrialSetup setup = wall(Conditions::ideal);
  setup.network = network_of("delay 50ms");
  const Trial trial = run_trial(setup);
  EXPECT_LT(trial.passivity_minimum_J, -1);
  EXPECT_FALSE(trial.calm);
  EXPECT_GT(trial.restlessness, 0.5);
  EXPECT_GT(trial.error, 0.5);
  setup.law = "fba-exact";
  EXPECT_GE(run_trial(setup).passivity_minimum_J, -1e-9);
}

TEST(Trial, MeasuresTheDriftOfACouplingWithoutDelay) {
  TrialSetup setup = wall(Conditions::ideal);
  setup.law = "vc";
  const Trial trial = run_trial(setup);
  // The coupling is stretched by its force.
  EXPECT_GT(trial.drift_m, 1e-4);
  EXPECT_LT(trial.drift_m, 2e-3);
}

TEST(Trial, DoesNotTakeAMissingForceForRest) {
  TrialSetup setup = wall(Conditions::ideal);
  setup.law = "fba-more";
  setup.network = network_of("loss 100%");
  const Trial trial = run_trial(setup);
  EXPECT_FALSE(trial.calm);
  EXPECT_EQ(trial.shown_N_per_m, 0);
}

TEST(Trial, IsTheSameForTheSameSeed) {
  TrialSetup setup = wall(Conditions::real);
  setup.network = network_of("delay 10ms 5ms loss 10%");
  setup.law = "fba-less";
  const Trial first = run_trial(setup);
  EXPECT_EQ(run_trial(setup).error, first.error);
  setup.seed = 2;
  EXPECT_NE(run_trial(setup).error, first.error);
}

}  // namespace
}  // namespace forcebound::lab
