#include "forcebound/scene/geometry/lathe.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

namespace forcebound::scene {
namespace {

using std::numbers::pi;

/// A regular polygon of n corners has this share of its circle's area.
double share_of_circle(int n) { return n / (2 * pi) * std::sin(2 * pi / n); }

TEST(Lathe, OfATubeIsClosedAndHasItsVolume) {
  const TriangleMesh tube = make_lathe("tube", {{0.02, 0}, {0.03, 0}, {0.03, 0.1}, {0.02, 0.1}}, 64);
  EXPECT_TRUE(tube.report().closed());
  EXPECT_EQ(tube.report().triangles, 8U * 64);
  const double exact_m3 = pi * (0.03 * 0.03 - 0.02 * 0.02) * 0.1 * share_of_circle(64);
  EXPECT_NEAR(tube.report().volume_m3, exact_m3, 1e-12);
}

TEST(Lathe, OfAConeMeetsInItsTip) {
  const TriangleMesh cone = make_lathe("cone", {{0, 0}, {0.03, 0}, {0, 0.06}}, 100, {1, 2, 3});
  EXPECT_TRUE(cone.report().closed());
  EXPECT_EQ(cone.report().vertices, 102U);
  EXPECT_NEAR(cone.report().volume_m3, pi * 0.03 * 0.03 * 0.06 / 3 * share_of_circle(100), 1e-12);
  EXPECT_NEAR((cone.origin_m() - Point(1, 2, 3.03)).norm(), 0, 1e-12);
}

std::string error_of(const std::vector<LathePoint>& profile, int segments) {
  try {
    (void)make_lathe("pot", profile, segments);
  } catch (const GeometryError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Lathe, RefusesInvalidProfiles) {
  EXPECT_EQ(error_of({{0, 0}, {1, 0}}, 10), "pot: a profile has at least 3 points, got 2");
  EXPECT_EQ(error_of({{0, 0}, {1, 0}, {0, 1}}, 2), "pot: segments must be 3 to 4096, got 2");
  EXPECT_EQ(error_of({{0, 0}, {-1, 0}, {0, 1}}, 10), "pot: a radius of the profile must be >= 0");
}

}  // namespace
}  // namespace forcebound::scene
