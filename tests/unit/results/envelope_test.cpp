#include "forcebound/results/envelope.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::results {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(Envelope, KeepsShortCurvesAsTheyAre) {
  Envelope envelope(2);
  for (int i = 0; i < 1000; ++i) envelope.add(i, std::array<double, 2>{static_cast<double>(i % 7), -0.5 * i});
  const auto points = envelope.points();
  ASSERT_EQ(points.size(), 1000U);
  for (std::size_t i = 0; i < 1000; ++i) {
    EXPECT_EQ(points[i].x, static_cast<double>(i));
    EXPECT_EQ(points[i].y[0], static_cast<double>(i % 7));
    EXPECT_EQ(points[i].y[1], -0.5 * static_cast<double>(i));
  }
}

TEST(Envelope, ThinsAMillionPointsAndLosesNoSpike) {
  Envelope envelope(2);
  for (int i = 0; i < 1'000'000; ++i) {
    const double spike = i == 123'456 ? 50 : (i == 777'777 ? -60 : 0);
    envelope.add(i, std::array{0.0, std::sin(i * 1e-4) + spike});
  }
  const auto points = envelope.points();
  EXPECT_LE(points.size(), 6000U);
  EXPECT_GE(points.size(), 2000U);
  EXPECT_TRUE(std::ranges::is_sorted(points, {}, &Envelope::Point::x));
  const auto of_second = [](const Envelope::Point& point) { return point.y[1]; };
  EXPECT_GT(std::ranges::max(points, {}, of_second).y[1], 49);
  EXPECT_LT(std::ranges::min(points, {}, of_second).y[1], -59);
}

TEST(Envelope, KeepsAnEdgesDirectionWithinAColumn) {
  Envelope envelope(1);
  for (int i = 0; i < 4000; ++i) envelope.add(i, std::array<double, 1>{static_cast<double>(i)});
  EXPECT_TRUE(std::ranges::is_sorted(envelope.points(), {}, [](const auto& point) { return point.y[0]; }));
}

TEST(Envelope, NeverJoinsWhatAGapPartsWhateverTheOtherCurveDoes) {
  Envelope envelope(2);
  constexpr int kLength = 300;  // contact and none by turns, each contact at another height
  for (int i = 0; i < 60'000; ++i) {
    const int contact = i / kLength;
    envelope.add(i, std::array{contact % 2 == 0 ? contact : kNone, std::sin(i)});
  }
  const auto points = envelope.points();
  for (std::size_t i = 1; i < points.size(); ++i) {
    EXPECT_FALSE(std::isnan(points[i].y[1]));
    if (std::isnan(points[i].y[0]) || std::isnan(points[i - 1].y[0])) continue;
    EXPECT_EQ(points[i].y[0], points[i - 1].y[0]) << "at " << points[i].x;
  }
}

TEST(Envelope, FindsRoomForACurveOfGapsAlone) {
  Envelope envelope(1);
  for (int i = 0; i < 100'000; ++i) envelope.add(i, std::array{i % 2 == 0 ? 1 : kNone});
  EXPECT_LE(envelope.points().size(), 6000U);
}

TEST(Envelope, InterruptsTheCurveWhereAValueIsMissing) {
  Envelope envelope(1);
  for (const auto& [x, y] : {std::array{0.0, 1.0}, {1.0, kNone}, {2.0, kNone}, {3.0, 4.0}}) {
    envelope.add(x, std::array{y});
  }
  const auto points = envelope.points();
  ASSERT_EQ(points.size(), 4U);
  EXPECT_EQ(points[0].y[0], 1);
  EXPECT_TRUE(std::isnan(points[1].y[0]));
  EXPECT_TRUE(std::isnan(points[2].y[0]));
  EXPECT_EQ(points[3].y[0], 4);
}

TEST(Envelope, AddDoesNotAllocate) {
  if (!time::kCountsHeapOperations) GTEST_SKIP() << "allocations are not counted under sanitizers";
  Envelope envelope(2);
  const auto before = time::heap_operations_of_this_thread();
  for (int i = 0; i < 100'000; ++i) envelope.add(i, std::array{i % 100 == 0 ? kNone : i % 13, 1.0});
  EXPECT_EQ(time::heap_operations_of_this_thread(), before);
}

}  // namespace
}  // namespace forcebound::results
