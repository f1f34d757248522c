#include "tests/tools/lab/comparison/rate_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace forcebound::lab {
namespace {

std::vector<AtRate> study(const RateSettings& settings) {
  return run_rate_study(settings, [](auto, auto) {});
}

TEST(RateStudy, ShowsStifferWallsAtAFasterLoop) {
  const auto found = study({.devices = {"wall-1dof"}, .laws = {"none", "fba-exact"}, .rates_Hz = {1000, 4000}});
  ASSERT_EQ(found.size(), 4U);
  const AtRate& none = found[0];
  const AtRate& none_fast = found[2];
  EXPECT_GE(none.stable.N_per_m, 0.98 * none.passive_N_per_m);
  EXPECT_GE(none_fast.stable.N_per_m, 0.98 * none_fast.passive_N_per_m);
  EXPECT_FALSE(none_fast.stable.no_limit);
  EXPECT_LT(none_fast.late_N_per_m, none_fast.passive_N_per_m);
  const AtRate& exact = found[1];
  const AtRate& exact_fast = found[3];
  EXPECT_EQ(exact.law, "fba-exact");
  EXPECT_TRUE(exact.stable.no_limit);
  EXPECT_GT(exact_fast.ideal.shown_N_per_m, exact.ideal.shown_N_per_m);
  for (const AtRate& passive : {exact, exact_fast}) {
    EXPECT_GE(passive.ideal.least_P_J, -1e-9);
    EXPECT_GE(passive.own.least_P_J, -1e-9);
  }
  EXPECT_LT(none.ideal.least_P_J, 0);
  EXPECT_THAT(rate_csv(found), testing::HasSubstr("wall-1dof,none,4000,240,"));
}

TEST(RateStudy, RefusesARateAtWhichTheDeviceLetsGoFirst) {
  EXPECT_THROW((void)study({.devices = {"wall-1dof"}, .laws = {"none"}, .rates_Hz = {400}}), std::invalid_argument);
}

}  // namespace
}  // namespace forcebound::lab
