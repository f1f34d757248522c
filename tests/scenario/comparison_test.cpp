#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/tools/lab/comparison/trial.hpp"

#include "forcebound/baselines/baselines.hpp"

// The baseline laws in the closed loop, on the paper's device [Kim 2015, section VI]:
//
//   hand -- device -- law ==( network )== server -- wall, circle or sphere
namespace forcebound::lab {
namespace {

constexpr double kB_N_per_m = 30e3;  // b/T of the paper's one-axis device

TrialSetup stiff_wall(const std::string& law) {
  return {.task = task_of("wall"),
          .stiffness_N_per_m = 150e3,
          .network = network_of("none"),
          .conditions = Conditions::ideal,
          .law = law};
}

TEST(EnergyBounding, ShowsDampingOverPeriodOnAStiffWall) {
  EXPECT_NEAR(run_trial(stiff_wall("eba")).shown_N_per_m, kB_N_per_m, 0.02 * kB_N_per_m);
}

TEST(MoreConservative, ShowsTwiceDampingOverPeriodOnAStiffWall) {
  EXPECT_NEAR(run_trial(stiff_wall("fba-more")).shown_N_per_m, 2 * kB_N_per_m, 0.02 * 2 * kB_N_per_m);
}

TEST(VirtualCoupling, ShowsItsCouplingAndTheWallInSeries) {
  TrialSetup setup = stiff_wall("vc");
  const double coupling =
      baselines::shipped_laws().parameters("vc", settings_of(setup).device.facts).at("coupling_N_per_m");
  const double series = coupling * setup.stiffness_N_per_m / (coupling + setup.stiffness_N_per_m);
  EXPECT_NEAR(run_trial(setup).shown_N_per_m, series, 0.02 * series);
}

TEST(OutputLimiter, IsTheLessConservativeLawOnOneAxisAndBendsTheForceOnThree) {
  TrialSetup setup = stiff_wall("aol");
  const Trial limited = run_trial(setup);
  setup.law = "fba-less";
  const Trial less = run_trial(setup);
  EXPECT_NEAR(limited.error, less.error, 1e-12);
  EXPECT_NEAR(limited.force_N_mean, less.force_N_mean, 1e-12);
  const TrialSetup ball{.task = task_of("sphere"), .network = network_of("none"), .law = "aol"};
  EXPECT_GT(run_trial(ball).direction_error_rad, 0.1);
}

class EveryLaw : public testing::TestWithParam<std::string> {};

TEST_P(EveryLaw, PlaysOnEveryTaskThroughABadNetwork) {
  for (const char* const scene : {"wall", "circle", "sphere"}) {
    const TrialSetup setup{
        .task = task_of(scene), .network = network_of("delay 20ms 10ms loss 10%"), .law = GetParam()};
    const Trial trial = run_trial(setup);
    ASSERT_EQ(trial.refused, "") << scene;
    EXPECT_TRUE(std::isfinite(trial.passivity_minimum_J)) << scene;
    EXPECT_TRUE(std::isfinite(trial.error)) << scene;
    // A tool at the server may have drifted, so that the device is not in contact any more.
    EXPECT_TRUE(trial.force_N_mean > 0 || trial.drift_m > 1e-3) << scene;
  }
}

std::string test_name(const testing::TestParamInfo<std::string>& law) {
  std::string name = law.param;
  std::erase(name, '-');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Comparison, EveryLaw, testing::ValuesIn(baselines::shipped_laws().names()), test_name);

std::vector<std::string> promising_laws() {
  const control::LawRegistry laws = baselines::shipped_laws();
  std::vector<std::string> names = laws.names();
  std::erase_if(names, [&](const std::string& law) { return laws.find(law).claim == control::LawClaim::nothing; });
  return names;
}

class PromisingLaw : public testing::TestWithParam<std::string> {};

TEST_P(PromisingLaw, IsPassiveWithAnIdealDevice) {
  TrialSetup setup = stiff_wall(GetParam());
  setup.network = network_of("delay 50ms 20ms loss 5%");
  EXPECT_GE(run_trial(setup).passivity_minimum_J, kPassive_J);
}

INSTANTIATE_TEST_SUITE_P(Comparison, PromisingLaw, testing::ValuesIn(promising_laws()), test_name);

}  // namespace
}  // namespace forcebound::lab
