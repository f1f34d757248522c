#include "tests/tools/lab/comparison/tuning.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace forcebound::lab {
namespace {

TEST(Score, IsTheErrorAtTheDevicePlusPenalties) {
  Trial trial;
  trial.error = 0.3;
  trial.calm = true;
  EXPECT_DOUBLE_EQ(score(trial), 0.3);
  trial.calm = false;
  EXPECT_DOUBLE_EQ(score(trial), 1.3);
  trial.passivity_minimum_J = -1e-3;
  EXPECT_DOUBLE_EQ(score(trial), 2.3);
  trial.error = std::nan("");
  EXPECT_DOUBLE_EQ(score(trial), 4);
  trial.refused = "no";
  EXPECT_EQ(score(trial), std::numeric_limits<double>::infinity());
}

std::vector<TrialSetup> one_wall() {
  return {{.task = task_of("wall"), .stiffness_N_per_m = 10e3, .network = network_of("none")}};
}

TEST(Tuning, TriesNothingForALawWithoutParameters) {
  const Tuning tuning = tune("fba-less", one_wall(), 5, 1);
  EXPECT_EQ(tuning.tried, 0);
  EXPECT_TRUE(tuning.best.empty());
}

TEST(Tuning, MakesTheSameEffortForALawThatRefusesMuchOfWhatIsDrawn) {
  const Tuning tuning = tune("vc", one_wall(), 6, 1);
  EXPECT_EQ(tuning.tried, 6);
  EXPECT_GT(tuning.refused, 0);
  EXPECT_LE(tuning.best_score, tuning.standard_score);
  EXPECT_EQ(tuning.best.size(), tuning.standard.size());
}

TEST(Tuning, FindsTheSameForTheSameSeed) {
  const Tuning once = tune("eba", one_wall(), 4, 7);
  EXPECT_EQ(tune("eba", one_wall(), 4, 7).best, once.best);
}

}  // namespace
}  // namespace forcebound::lab
