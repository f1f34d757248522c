#include "tests/tools/netem/delay_distribution.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace forcebound::netem {
namespace {

struct Moments {
  double mean_ms = 0;
  double deviation_ms = 0;
  double least_ms = std::numeric_limits<double>::max();
  double most_ms = std::numeric_limits<double>::lowest();
};

Moments measure_delays(const char* words) {
  constexpr int kPackets = 1'000'000;
  Random random(7);
  DelayDistribution distribution(parse_netem(words).delay, random);
  Moments moments;
  double sum = 0;
  double squares = 0;
  for (int i = 0; i < kPackets; ++i) {
    const double ms = static_cast<double>(distribution.next(random).count()) * 1e-6;
    sum += ms;
    squares += ms * ms;
    moments.least_ms = std::min(moments.least_ms, ms);
    moments.most_ms = std::max(moments.most_ms, ms);
  }
  moments.mean_ms = sum / kPackets;
  moments.deviation_ms = std::sqrt(squares / kPackets - moments.mean_ms * moments.mean_ms);
  return moments;
}

TEST(DelayDistribution, WithoutJitterIsConstant) {
  const Moments moments = measure_delays("delay 50ms");
  EXPECT_EQ(moments.least_ms, 50);
  EXPECT_EQ(moments.most_ms, 50);
}

TEST(DelayDistribution, JitterWithoutDistributionIsUniform) {
  const Moments moments = measure_delays("delay 50ms 10ms");
  EXPECT_NEAR(moments.least_ms, 40, 0.001);
  EXPECT_NEAR(moments.most_ms, 60, 0.001);
  EXPECT_GE(moments.least_ms, 40);
  EXPECT_LT(moments.most_ms, 60);
  EXPECT_NEAR(moments.mean_ms, 50, 0.02);
  EXPECT_NEAR(moments.deviation_ms, 10 / std::sqrt(3), 0.01);
}

TEST(DelayDistribution, UniformJitterOfManySecondsKeepsItsWidth) {
  const Moments moments = measure_delays("delay 60s 50s");
  EXPECT_NEAR(moments.least_ms, 10'000, 10);
  EXPECT_NEAR(moments.most_ms, 110'000, 10);
  EXPECT_NEAR(moments.deviation_ms, 50'000 / std::sqrt(3), 50);
}

TEST(DelayDistribution, MayBeNegative) { EXPECT_LT(measure_delays("delay 1ms 10ms").least_ms, -8.9); }

TEST(DelayDistribution, NormalHasItsMeanAndItsSigma) {
  const Moments moments = measure_delays("delay 50ms 10ms distribution normal");
  EXPECT_NEAR(moments.mean_ms, 50, 0.05);
  EXPECT_NEAR(moments.deviation_ms, 10, 0.05);
  EXPECT_NEAR(moments.least_ms, 10, 0.001);  // clamped at four sigma
}

TEST(DelayDistribution, ParetoHasItsShortestDelayAndALongTail) {
  const Moments moments = measure_delays("delay 50ms 9ms distribution pareto");
  EXPECT_NEAR(moments.least_ms, 50 - 9 * 2.0 / 3, 0.002);
  EXPECT_NEAR(moments.most_ms, 50 + 9 * 4, 0.002);
}

TEST(DelayTable, NormalIsTheInverseNormal) {
  const DelayTable table = make_delay_table(DelayShape::normal);
  EXPECT_EQ(table[2048], 0);
  EXPECT_EQ(table[0], -32768);
  // Quantiles from tables: u = 0.025, 0.75 and 0.99.
  EXPECT_NEAR(table[102], -1.9617 * kDelayTableSigma, 15);  // 102/4096 = 0.0249
  EXPECT_NEAR(table[3072], 0.67449 * kDelayTableSigma, 1);
  EXPECT_NEAR(table[4055], 2.3263 * kDelayTableSigma, 15);  // 4055/4096 = 0.98999
  for (std::size_t i = 1; i < 2048; ++i) EXPECT_EQ(table[i], -table[4096 - i]) << i;
  EXPECT_TRUE(std::is_sorted(table.begin(), table.end()));
}

TEST(DelayTable, ParetoIsItsFormulaClamped) {
  const DelayTable table = make_delay_table(DelayShape::pareto);
  EXPECT_EQ(table[0], std::lround(-2.0 / 3 * kDelayTableSigma));
  // 1 - u = 1/8 at i = 3584: 4/3 (2 - 1.5) sigma.
  EXPECT_EQ(table[3584], std::lround(2.0 / 3 * kDelayTableSigma));
  // 1 - u = 1/64 at i = 4032: 4/3 (4 - 1.5) sigma.
  EXPECT_EQ(table[4032], std::lround(10.0 / 3 * kDelayTableSigma));
  EXPECT_EQ(table[4095], 32767);
}

TEST(DelayTable, ParetonormalIsAQuarterNormalAndThreeQuartersPareto) {
  const DelayTable normal = make_delay_table(DelayShape::normal);
  const DelayTable pareto = make_delay_table(DelayShape::pareto);
  const DelayTable mixed = make_delay_table(DelayShape::paretonormal);
  for (const std::size_t i : {1U, 100U, 2048U, 3000U, 4032U})
    EXPECT_NEAR(mixed[i], (normal[i] + 3.0 * pareto[i]) / 4, 1) << i;
}

TEST(DelayTable, UniformNeedsNone) { EXPECT_THROW(make_delay_table(DelayShape::uniform), std::invalid_argument); }

}  // namespace
}  // namespace forcebound::netem
