#include "tests/tools/lab/label_placement.hpp"

#include <gtest/gtest.h>

#include <random>

namespace forcebound::lab {
namespace {

constexpr Box kArea{0, 0, 1200, 270};

TEST(PlaceNames, PutsASingleNameBesideItsPoint) {
  const auto placed = place_names({{100, 100, "fba-exact"}}, kArea);
  ASSERT_EQ(placed.size(), 1U);
  EXPECT_GT(placed[0].box.left, 100);
  EXPECT_LT(placed[0].box.left, 115);
  EXPECT_FALSE(placed[0].joined);
}

TEST(PlaceNames, LetsNoNameCoverAnotherOrAPoint) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> aside(-25, 25);
  for (int round = 0; round < 50; ++round) {
    std::vector<NamedPoint> points;
    points.reserve(14);
    for (int i = 0; i < 14; ++i) points.push_back({600 + 3 * aside(random), 135 + aside(random), "tdpa-2port"});
    const auto placed = place_names(points, kArea);
    ASSERT_EQ(placed.size(), points.size());
    for (std::size_t i = 0; i < placed.size(); ++i) {
      EXPECT_TRUE(placed[i].box.within(kArea));
      for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(placed[i].box.overlaps(placed[j].box)) << i << " and " << j;
      for (const NamedPoint& point : points) {
        EXPECT_FALSE(placed[i].box.overlaps({point.x - 1, point.y - 1, point.x + 1, point.y + 1}));
      }
    }
  }
}

TEST(PlaceNames, StaysWithinItsArea) {
  for (const NamedPoint& corner :
       {NamedPoint{1, 1, "none"}, {1199, 1, "none"}, {1, 269, "none"}, {1199, 269, "none"}}) {
    EXPECT_TRUE(place_names({corner}, kArea).front().box.within(kArea)) << corner.x << ", " << corner.y;
  }
}

}  // namespace
}  // namespace forcebound::lab
