#include "tests/tools/lab/bench/readings.hpp"
#include "tests/tools/lab/trials/percentile.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <stdexcept>

namespace forcebound::lab {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using testing::ThrowsMessage;

TEST(Sockperf, IsReadFromWhatItSays) {
  const Sockperf read = read_sockperf(
      "sockperf: ====> avg-rtt=97.252 (std-dev=231.3)\n"
      "sockperf: ---> <MAX> observation = 9093.464\n"
      "sockperf: ---> percentile 99.000 =  148.508\n"
      "sockperf: ---> percentile 50.000 =   94.488\n");
  EXPECT_EQ(read.p50_us, 94.488);
  EXPECT_EQ(read.p99_us, 148.508);
}

TEST(Sockperf, ThatMeasuredNothingIsRefused) {
  EXPECT_THAT([] { static_cast<void>(read_sockperf("sockperf: No messages were received from the server.")); },
              ThrowsMessage<std::runtime_error>(HasSubstr("percentile 50.000")));
}

TEST(Cyclictest, IsReadInOrderWithoutOtherOutput) {
  const auto latencies = read_cyclictest_us(
      "Max CPUs = 2\n# /dev/cpu_dma_latency set to 0us\nThread 0 Interval: 1000\n"
      "       0:       0:   43011\n       0:       1:    2500\n       1:       0:    9\n       0:       2:   10000\n");
  EXPECT_THAT(latencies, ElementsAre(43.011, 2.5, 10));
}

TEST(Cyclictest, ThatMeasuredNothingIsRefused) {
  EXPECT_THROW(static_cast<void>(read_cyclictest_us("unable to get scheduling parameters\n")), std::runtime_error);
}

TEST(Periods, AreThoseBetweenWakeUpsThatAreLate) { EXPECT_THAT(periods_us(1000, {5, 105, 4}), ElementsAre(1100, 899)); }

TEST(Percentile, IsTheNearestRankAndOfAnEvenCountTheMeanOfTheTwoMiddleValues) {
  EXPECT_EQ(percentile({3, 1, 2}, 0.5), 2);
  EXPECT_EQ(percentile({3, 1, 2}, 0), 1);
  EXPECT_EQ(percentile({3, 1, 2}, 0.999), 3);
  EXPECT_EQ(percentile({4, 3, 1, 2}, 0.5), 2.5);
  EXPECT_EQ(percentile({10, 0}, 0.5), 5);
  EXPECT_EQ(percentile({4, 3, 1, 2}, 0.75), 3);
  EXPECT_EQ(percentile({4, 3, 1, 2}, 1), 4);
  EXPECT_THROW(static_cast<void>(percentile({}, 0.5)), std::runtime_error);
}

TEST(Benchmarks, AreTheMediansOfRepetitionsAndOtherwiseTheRun) {
  const Benchmarks all = read_benchmarks(R"({"benchmarks": [
    {"name": "a/1", "run_name": "a/1", "run_type": "iteration", "cpu_time": 5, "time_unit": "ns"},
    {"name": "a/1", "run_name": "a/1", "run_type": "iteration", "cpu_time": 7, "time_unit": "ns"},
    {"name": "a/1_mean", "run_name": "a/1", "run_type": "aggregate", "aggregate_name": "mean", "cpu_time": 9, "time_unit": "ns"},
    {"name": "a/1_median", "run_name": "a/1", "run_type": "aggregate", "aggregate_name": "median", "cpu_time": 6, "time_unit": "ns"},
    {"name": "b/boxes:5/iterations:2000", "run_name": "b/boxes:5/iterations:2000", "run_type": "iteration", "cpu_time": 2, "time_unit": "us"}
  ]})");
  EXPECT_THAT(all, ElementsAre(Pair("a/1", 6), Pair("b/boxes:5", 2000)));
  EXPECT_THROW(static_cast<void>(read_benchmarks("{}")), std::runtime_error);
  EXPECT_THROW(static_cast<void>(read_benchmarks("")), std::runtime_error);
}

TEST(Benchmarks, AreReadInSpiteOfBareNaN) {
  const Benchmarks all = read_benchmarks(R"({"benchmarks": [
    {"name": "\"NaN\"", "run_type": "iteration", "cpu_time": 5, "time_unit": "ns"},
    {"name": "a_cv", "run_name": "a", "run_type": "aggregate", "aggregate_name": "cv", "cpu_time": NaN,
     "time_unit": "ns", "heap": -NaN, "rate": Infinity, "least": -Infinity},
    {"name": "a_median", "run_name": "a", "run_type": "aggregate", "aggregate_name": "median", "cpu_time": 6,
     "time_unit": "ns", "heap": 0}
  ]})");
  EXPECT_THAT(all, ElementsAre(Pair("\"NaN\"", 5), Pair("a", 6)));
}

TEST(Benchmarks, WithoutATimeAreRefused) {
  EXPECT_THAT(
      [] {
        static_cast<void>(read_benchmarks(
            R"({"benchmarks": [{"name": "a", "run_type": "iteration", "cpu_time": NaN, "time_unit": "ns"}]})"));
      },
      ThrowsMessage<std::runtime_error>(HasSubstr("a has no time")));
}

TEST(Benchmarks, AreSortedBySizeWhetherItHasANameOrNot) {
  const Benchmarks all{{"step/8", 80}, {"step/16", 160}, {"step_more/8", 1}, {"nearest/triangles:1088", 3}};
  EXPECT_THAT(by_size(all, "step"), ElementsAre(Pair(8, 80), Pair(16, 160)));
  EXPECT_THAT(by_size(all, "nearest"), ElementsAre(Pair(1088, 3)));
}

TEST(Growth, IsTheExponentOfAPower) {
  for (const double exponent : {-0.5, 0.0, 1.0, 1.7, 3.0}) {
    std::map<double, double> cost;
    for (const double size : {10, 30, 100, 1000}) cost[size] = 4e-3 * std::pow(size, exponent);
    EXPECT_NEAR(growth(cost), exponent, 1e-12);
  }
}

TEST(Growth, IsTheBestFitWhereItIsNoPower) {
  // Logarithms 0, 1, 1, 2 over 0, 1, 2, 3: slope 0.6.
  const double e = std::exp(1.0);
  EXPECT_THAT(growth({{1, 1}, {e, e}, {e * e, e}, {e * e * e, e * e}}), DoubleNear(0.6, 1e-12));
}

TEST(Growth, NeedsFourSizesAndPositiveNumbers) {
  EXPECT_THAT(
      [] {
        static_cast<void>(growth({{1, 1}, {2, 2}, {3, 3}}));
      },
      ThrowsMessage<std::runtime_error>(HasSubstr("at least 4 sizes, got 3")));
  EXPECT_THROW(static_cast<void>(growth({{1, 1}, {2, 2}, {3, 3}, {4, 0}})), std::runtime_error);
  EXPECT_THROW(static_cast<void>(growth({{0, 1}, {2, 2}, {3, 3}, {4, 4}})), std::runtime_error);
}

}  // namespace
}  // namespace forcebound::lab
