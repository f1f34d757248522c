#include "forcebound/record/running_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace forcebound::record {
namespace {

TEST(RunningStatistics, KnowTheClosedFormOfOneToN) {
  RunningStatistics statistics;
  constexpr int kN = 1000;
  for (int i = 1; i <= kN; ++i) statistics.add(i);
  EXPECT_DOUBLE_EQ(statistics.mean(), (kN + 1) / 2.0);
  EXPECT_NEAR(statistics.variance(), (kN * kN - 1) / 12.0, 1e-8);
  EXPECT_EQ(statistics.max(), kN);
}

TEST(RunningStatistics, DoNotCancelFarFromZero) {
  RunningStatistics statistics;
  for (int i = 0; i < 100'000; ++i) statistics.add(1e9 + (i % 2 == 0 ? 0.5 : -0.5));
  EXPECT_NEAR(statistics.variance(), 0.25, 1e-6);
}

TEST(RunningStatistics, HaveNoMeanWithoutValues) {
  EXPECT_TRUE(std::isnan(RunningStatistics().mean()));
  EXPECT_TRUE(std::isnan(RunningStatistics().variance()));
  EXPECT_TRUE(std::isnan(RunningStatistics().max()));
}

TEST(RunningStatistics, HaveMaximumOfNegativeValues) {
  RunningStatistics statistics;
  statistics.add(-3);
  statistics.add(-2);
  EXPECT_EQ(statistics.max(), -2);
}

}  // namespace
}  // namespace forcebound::record
