#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/allocation_guard.hpp"
#include "tests/tools/lab/figure.hpp"

namespace forcebound::lab {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(Envelope, KeepsAShortCurveAsItIs) {
  Envelope envelope;
  for (int i = 0; i < 1000; ++i) envelope.add(i, i % 7);
  const Series series = envelope.series("a", colour::kApplied);
  ASSERT_EQ(series.x.size(), 1000U);
  for (std::size_t i = 0; i < 1000; ++i) {
    EXPECT_EQ(series.x[i], static_cast<double>(i));
    EXPECT_EQ(series.y[i], static_cast<double>(i % 7));
  }
}

TEST(Envelope, ThinsAMillionPointsAndLosesNoSpike) {
  Envelope envelope;
  for (int i = 0; i < 1'000'000; ++i) {
    const double spike = i == 123'456 ? 50 : (i == 777'777 ? -60 : 0);
    envelope.add(i, std::sin(i * 1e-4) + spike);
  }
  const Series series = envelope.series("a", colour::kApplied);
  EXPECT_LE(series.x.size(), 8000U);
  EXPECT_GE(series.x.size(), 2000U);
  EXPECT_TRUE(std::is_sorted(series.x.begin(), series.x.end()));
  EXPECT_GT(*std::max_element(series.y.begin(), series.y.end()), 49);
  EXPECT_LT(*std::min_element(series.y.begin(), series.y.end()), -59);
}

TEST(Envelope, NeverJoinsWhatAGapParts) {
  Envelope envelope;
  constexpr int kLength = 300;  // contact and none by turns, each contact at another height
  for (int i = 0; i < 60'000; ++i) {
    const int contact = i / kLength;
    envelope.add(i, contact % 2 == 0 ? contact : kNone);
  }
  const Series series = envelope.series("a", colour::kApplied);
  for (std::size_t i = 1; i < series.y.size(); ++i) {
    if (std::isnan(series.y[i]) || std::isnan(series.y[i - 1])) continue;
    EXPECT_EQ(series.y[i], series.y[i - 1]) << "at " << series.x[i];
  }
}

TEST(Envelope, FindsRoomForACurveOfGapsAlone) {
  Envelope envelope;
  for (int i = 0; i < 100'000; ++i) envelope.add(i, i % 2 == 0 ? 1 : kNone);
  EXPECT_LE(envelope.series("a", colour::kApplied).x.size(), 12'000U);
}

TEST(Envelope, BreaksTheCurveWhereAValueIsMissing) {
  Envelope envelope;
  envelope.add(0, 1);
  envelope.add(1, kNone);
  envelope.add(2, kNone);
  envelope.add(3, 4);
  const Series series = envelope.series("a", colour::kApplied);
  ASSERT_EQ(series.y.size(), 3U);
  EXPECT_TRUE(std::isnan(series.y[1]));
}

TEST(Envelope, AddDoesNotAllocate) {
  if (!time::kCountsHeapOperations) GTEST_SKIP() << "allocations are not counted under sanitizers";
  Envelope envelope;
  const auto before = time::heap_operations_of_this_thread();
  for (int i = 0; i < 100'000; ++i) envelope.add(i, i % 100 == 0 ? kNone : i % 13);
  EXPECT_EQ(time::heap_operations_of_this_thread(), before);
}

}  // namespace
}  // namespace forcebound::lab
