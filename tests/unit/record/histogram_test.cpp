#include "forcebound/record/histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <random>
#include <vector>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::record {
namespace {

/// But for the median of an even count.
double nearest_rank(const std::vector<std::int64_t>& sorted, double fraction) {
  const std::size_t half = sorted.size() / 2;
  if (fraction == 0.5 && sorted.size() % 2 == 0) return 0.5 * static_cast<double>(sorted[half - 1] + sorted[half]);
  const auto rank = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(sorted.size())));
  return static_cast<double>(sorted[std::max<std::size_t>(rank, 1) - 1]);
}

Histogram histogram_of(std::initializer_list<std::int64_t> values) {
  Histogram histogram;
  for (const std::int64_t value : values) histogram.add(value);
  return histogram;
}

TEST(Histogram, IsWithinATwoThousandthOfTheSortedValuesOverTwelveDecades) {
  std::mt19937_64 random(20260101);
  std::uniform_real_distribution<double> decades(0, 12);
  Histogram histogram;
  std::vector<std::int64_t> values;
  values.reserve(20000);
  for (int i = 0; i < 20000; ++i) values.push_back(static_cast<std::int64_t>(std::pow(10, decades(random))));
  for (const auto value : values) histogram.add(value);
  std::sort(values.begin(), values.end());
  for (const double fraction : {0.001, 0.01, 0.25, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const double exact = nearest_rank(values, fraction);
    EXPECT_NEAR(histogram.percentile(fraction), exact, 0.0005 * exact) << fraction;
  }
  EXPECT_EQ(histogram.max(), static_cast<double>(values.back()));
}

TEST(Histogram, IsExactBelow1024) {
  Histogram histogram;
  for (int value = 0; value < 1024; ++value) histogram.add(value);
  EXPECT_EQ(histogram.percentile(0.5), 511.5);
  EXPECT_EQ(histogram.percentile(1.0), 1023);
  EXPECT_EQ(histogram.percentile(0.0), 0);
}

TEST(Histogram, MedianOfAnEvenCountIsTheMeanOfTheTwoMiddleValues) {
  EXPECT_EQ(histogram_of({7}).percentile(0.5), 7);
  EXPECT_EQ(histogram_of({10, 1}).percentile(0.5), 5.5);
  EXPECT_EQ(histogram_of({9, 1, 4}).percentile(0.5), 4);
  EXPECT_EQ(histogram_of({100, 2, 8, 1}).percentile(0.5), 5);
  EXPECT_EQ(histogram_of({3, 3, 3, 9}).percentile(0.5), 3) << "both in one bucket";
  EXPECT_EQ(histogram_of({100, 2, 8, 1}).percentile(0.75), 8) << "of others the nearest rank";
}

TEST(Histogram, MergedIsAsIfAllHadBeenAddedToOne) {
  Histogram odd, even, all;
  for (std::int64_t value = 1; value < 5000; ++value) {
    (value % 2 == 0 ? even : odd).add(value * value);
    all.add(value * value);
  }
  odd.merge(even);
  EXPECT_EQ(odd.count(), all.count());
  EXPECT_EQ(odd.max(), all.max());
  for (const double fraction : {0.1, 0.5, 0.99}) EXPECT_EQ(odd.percentile(fraction), all.percentile(fraction));
}

TEST(Histogram, TakesEveryInteger) {
  Histogram histogram;
  histogram.add(std::numeric_limits<std::int64_t>::min());
  histogram.add(-1);
  histogram.add(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(histogram.count(), 3U);
  EXPECT_EQ(histogram.percentile(0.5), 0);
  EXPECT_EQ(histogram.max(), static_cast<double>(std::numeric_limits<std::int64_t>::max()));
}

TEST(Histogram, HasNoPercentileWithoutValues) {
  EXPECT_TRUE(std::isnan(Histogram().percentile(0.5)));
  EXPECT_TRUE(std::isnan(Histogram().max()));
}

TEST(Histogram, AddDoesNotAllocate) {
  if (!forcebound::time::kCountsHeapOperations) GTEST_SKIP() << "allocations are not counted under sanitizers";
  const auto before_construction = forcebound::time::heap_operations_of_this_thread();
  Histogram histogram;
  EXPECT_GT(forcebound::time::heap_operations_of_this_thread(), before_construction);  // the count works
  const auto before = forcebound::time::heap_operations_of_this_thread();
  for (std::int64_t value = 1; value < 1'000'000'000'000; value *= 3) histogram.add(value);
  EXPECT_EQ(forcebound::time::heap_operations_of_this_thread(), before);
}

}  // namespace
}  // namespace forcebound::record
