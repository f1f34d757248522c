#include "forcebound/handover/coverage.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace forcebound::handover {
namespace {

using Box = Eigen::AlignedBox3d;

TEST(Coverage, IsWithoutEndWhereNothingIsMissing) {
  EXPECT_TRUE(Coverage().whole());
  EXPECT_EQ(Coverage().known_within_m(Point(1, 2, 3)), std::numeric_limits<double>::infinity());
}

TEST(Coverage, IsNothingBeforeAnythingIsThere) {
  EXPECT_EQ(Coverage::nothing().known_within_m(Point(0.3, -5, 3)), 0);
  EXPECT_EQ(Coverage::nothing().slack_m(), 0) << "any piece is a gain";
}

TEST(Coverage, IsNothingAboutAPointThatIsNoNumberAndBoundedFarAway) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Box whole(Point::Constant(-0.1), Point::Constant(0.1));
  const Coverage coverage(whole, {Box(Point::Constant(0.05), Point::Constant(0.1))});
  EXPECT_EQ(coverage.known_within_m(Point(0, std::numeric_limits<double>::quiet_NaN(), 0)), 0);
  EXPECT_EQ(coverage.known_within_m(Point(kInfinity, kInfinity, kInfinity)), 0);
  EXPECT_GT(coverage.known_within_m(Point(-kInfinity, -kInfinity, -kInfinity)), 0.1);
}

TEST(Coverage, NeverTellsMoreThanTheWayToWhatIsMissing) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(-0.1, 0.1);
  const auto point = [&] { return Point(place(random), place(random), place(random)); };
  for (int i = 0; i < 20; ++i) {
    const Box whole(Point::Constant(-0.1), Point::Constant(0.1));
    std::vector<Box> missing;
    for (int j = 0; j < 10; ++j) {
      const Point corner = point();
      missing.emplace_back(corner, Point((corner + Point::Constant(0.01)).cwiseMin(0.1)));
    }
    const Coverage coverage(whole, missing);
    double most_m = 0;
    for (int j = 0; j < 500; ++j) {
      const Point at = 1.5 * point();
      double way_m = std::numeric_limits<double>::infinity();
      for (const Box& box : missing) way_m = std::min(way_m, box.exteriorDistance(at));
      const double reported_m = coverage.known_within_m(at);
      EXPECT_LE(reported_m, way_m);
      most_m = std::max(most_m, reported_m);
    }
    EXPECT_GT(most_m, 0.01);
  }
}

TEST(Coverage, TellsTheWayFromTheWholeCellToTheNearestOfManyBoxes) {
  constexpr double kCell_m = 0.01;
  const Box whole(Point::Zero(), Point::Constant(24 * kCell_m));
  std::mt19937_64 random(2);
  std::uniform_int_distribution<int> cell(0, 23);
  const auto cell_at = [&](int i, int j, int k) {
    const Point low_m = kCell_m * Point(i, j, k);
    return Box(low_m, Point(low_m + Point::Constant(kCell_m)));
  };
  std::vector<Box> missing;
  missing.reserve(200);
  for (int i = 0; i < 200; ++i) missing.push_back(cell_at(cell(random), cell(random) / 4, cell(random) / 8));
  const Coverage coverage(whole, missing);
  EXPECT_EQ(coverage.cells(), 24U * 24U * 24U);
  for (int i = 0; i < 2000; ++i) {
    const Box here = cell_at(cell(random), cell(random), cell(random));
    double way_m = std::numeric_limits<double>::infinity();
    for (const Box& box : missing) way_m = std::min(way_m, box.exteriorDistance(here));
    EXPECT_NEAR(coverage.known_within_m(here.center()), way_m, 1e-6) << here.center().transpose();
  }
}

}  // namespace
}  // namespace forcebound::handover
