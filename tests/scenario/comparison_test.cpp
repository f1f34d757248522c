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

Contest stiff_wall(const std::string& law) {
  return {.task = task_of("wall"),
          .stiffness_N_per_m = 150e3,
          .network = network_of("none"),
          .conditions = Conditions::ideal,
          .law = law};
}

TEST(EnergyBounding, ShowsDampingOverPeriodOnAStiffWall) {
  EXPECT_NEAR(play(stiff_wall("eba")).shown_N_per_m, kB_N_per_m, 0.02 * kB_N_per_m);
}

TEST(MoreConservative, ShowsTwiceDampingOverPeriodOnAStiffWall) {
  EXPECT_NEAR(play(stiff_wall("fba-more")).shown_N_per_m, 2 * kB_N_per_m, 0.02 * 2 * kB_N_per_m);
}

TEST(VirtualCoupling, ShowsItsCouplingAndTheWallInSeries) {
  Contest contest = stiff_wall("vc");
  const double coupling =
      baselines::shipped_laws().parameters("vc", settings_of(contest).device.facts).at("coupling_N_per_m");
  const double series = coupling * contest.stiffness_N_per_m / (coupling + contest.stiffness_N_per_m);
  EXPECT_NEAR(play(contest).shown_N_per_m, series, 0.02 * series);
}

TEST(OutputLimiter, IsTheLessConservativeLawOnOneAxisAndBendsTheForceOnThree) {
  Contest contest = stiff_wall("aol");
  const Trial limited = play(contest);
  contest.law = "fba-less";
  const Trial less = play(contest);
  EXPECT_NEAR(limited.error, less.error, 1e-12);
  EXPECT_NEAR(limited.force_N_mean, less.force_N_mean, 1e-12);
  const Contest ball{.task = task_of("sphere"), .network = network_of("none"), .law = "aol"};
  EXPECT_GT(play(ball).direction_error_rad, 0.1);
}

class EveryLaw : public testing::TestWithParam<std::string> {};

TEST_P(EveryLaw, PlaysOnEveryTaskThroughABadNetwork) {
  for (const char* const scene : {"wall", "circle", "sphere"}) {
    const Contest contest{.task = task_of(scene), .network = network_of("delay 20ms 10ms loss 10%"), .law = GetParam()};
    const Trial trial = play(contest);
    ASSERT_EQ(trial.refused, "") << scene;
    EXPECT_TRUE(std::isfinite(trial.passivity_minimum_J)) << scene;
    EXPECT_TRUE(std::isfinite(trial.error)) << scene;
    // A tool at the server may have wandered off, so that the device is nowhere in the surface any more.
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
  Contest contest = stiff_wall(GetParam());
  contest.network = network_of("delay 50ms 20ms loss 5%");
  EXPECT_GE(play(contest).passivity_minimum_J, kPassive_J);
}

INSTANTIATE_TEST_SUITE_P(Comparison, PromisingLaw, testing::ValuesIn(promising_laws()), test_name);

}  // namespace
}  // namespace forcebound::lab
