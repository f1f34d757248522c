#include "tests/lab/arena/tuning.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace forcebound::lab {
namespace {

TEST(Score, IsTheErrorAtTheDeviceAndMoreForWhatMustNotBe) {
  Bout bout;
  bout.error = 0.3;
  bout.calm = true;
  EXPECT_DOUBLE_EQ(score(bout), 0.3);
  bout.calm = false;
  EXPECT_DOUBLE_EQ(score(bout), 1.3);
  bout.passivity_minimum_J = -1e-3;
  EXPECT_DOUBLE_EQ(score(bout), 2.3);
  bout.error = std::nan("");
  EXPECT_DOUBLE_EQ(score(bout), 4);
  bout.refused = "no";
  EXPECT_EQ(score(bout), std::numeric_limits<double>::infinity());
}

std::vector<Contest> one_wall() {
  return {{.ground = ground_of("wall"), .stiffness_N_per_m = 10e3, .network = network_of("none")}};
}

TEST(Tuning, TriesNothingForALawWithoutParameters) {
  const Tuning tuning = tune("fba-less", one_wall(), 5, 1);
  EXPECT_EQ(tuning.tried, 0);
  EXPECT_TRUE(tuning.best.empty());
}

}  // namespace
}  // namespace forcebound::lab
