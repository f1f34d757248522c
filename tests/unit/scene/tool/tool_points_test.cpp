#include "forcebound/scene/tool/tool_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "forcebound/scene/geometry/bvh.hpp"
#include "tests/support/meshes.hpp"
#include "tests/unit/scene/tool/tool_scene.hpp"

namespace forcebound::scene {
namespace {

constexpr double kApart_m = 2e-3;

/// Distance to the nearest of the points.
double gap_m(const std::vector<ToolPoint>& points, const Point& at_m) {
  double least_m = 1;
  for (const ToolPoint& point : points) least_m = std::min(least_m, (point.at_m - at_m).norm());
  return least_m;
}

TEST(ToolPoints, OfABoxLieOnItsFacesNoFurtherApartThanTheSpacing) {
  const Point center_m(0.01, 0, -0.02);
  const Point size_m(0.02, 0.005, 0.011);
  const auto points = points_of("box", {{"center_m", center_m}, {"size_m", size_m}}, kApart_m);
  const auto box = make_box(center_m, size_m);
  for (const ToolPoint& point : points)
    EXPECT_NEAR(box->nearest(point.at_m, nullptr).penetration_m, 0, 1e-15) << point.at_m.transpose();
  for (double u = -0.5; u <= 0.5; u += 0.05) {
    for (double v = -0.5; v <= 0.5; v += 0.05) {
      for (const Point& at : {Point(u, v, 0.5), Point(0.5, u, v), Point(u, -0.5, v)})
        EXPECT_LE(gap_m(points, center_m + size_m.cwiseProduct(at)), kApart_m * 0.7072) << at.transpose();
    }
  }
  EXPECT_EQ(points_of("box", {{"center_m", center_m}, {"size_m", size_m}}, 1).size(), 8U) << "its corners";
}

TEST(ToolPoints, OfACylinderLieOnItsSurface) {
  const Point from_m(0, 0, 0);
  const Point to_m(0.01, 0.02, 0.02);
  const auto points = points_of("cylinder", {{"from_m", from_m}, {"to_m", to_m}, {"radius_m", 0.01}}, kApart_m);
  const Point axis = (to_m - from_m).normalized();
  for (const ToolPoint& point : points) {
    const double along_m = point.at_m.dot(axis);
    const double across_m = (point.at_m - along_m * axis).norm();
    EXPECT_TRUE(std::abs(across_m - 0.01) < 1e-12 || std::abs(along_m) < 1e-12 || std::abs(along_m - 0.03) < 1e-12);
    EXPECT_LE(across_m, 0.01 + 1e-12);
  }
  const Point x = axis.unitOrthogonal();
  for (double share = 0; share <= 1; share += 0.1) {
    EXPECT_LE(gap_m(points, share * to_m + 0.01 * x), kApart_m);
    EXPECT_LE(gap_m(points, to_m + share * 0.01 * x), kApart_m);
  }
}

TEST(ToolPoints, OfACapsuleAreBallsAlongItsAxis) {
  const auto points =
      points_of("capsule", {{"from_m", Point(0, 0, 0)}, {"to_m", Point(0, 0, 0.011)}, {"radius_m", 0.003}}, kApart_m);
  ASSERT_EQ(points.size(), 7U);
  for (const ToolPoint& point : points) EXPECT_EQ(point.radius_m, 0.003);
  EXPECT_EQ(points.front().at_m.z(), 0);
  EXPECT_NEAR(points.back().at_m.z(), 0.011, 1e-15);
}

std::vector<ToolPoint> points_of_mesh(const test::Soup& soup, double spacing_m = kApart_m) {
  return points_of_part("mesh", {}, {.mesh = test::shared_mesh(soup)}, spacing_m);
}

TEST(ToolPoints, OfAMeshLieOnItAndCoverIt) {
  const auto mesh = test::shared_mesh(test::ball(0.02, 5));
  const auto points = points_of_part("mesh", {}, {.mesh = mesh}, kApart_m);
  EXPECT_GT(points.size(), 500U);
  for (std::size_t i = 0; i < mesh->triangles().size(); ++i) {
    const Point middle_m = (mesh->corner_m(i, 0) + mesh->corner_m(i, 1) + mesh->corner_m(i, 2)) / 3;
    EXPECT_LE(gap_m(points, mesh->origin_m() + middle_m), 1.5 * kApart_m);
  }
  const Bvh tree(mesh);
  for (const ToolPoint& point : points) EXPECT_LT(tree.nearest(point.at_m - mesh->origin_m())->distance_m, 1e-12);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE((points[i].at_m - points[j].at_m).norm(), 0.5 * kApart_m);
  }
}

template <class Make>
std::string refusal(Make make) {
  try {
    (void)make();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ToolPoints, RefuseWhatIsNoToolInOneLine) {
  using testing::HasSubstr;
  EXPECT_THAT(refusal([] { return points_of_mesh(test::square(0.02, 4)); }), HasSubstr("must be closed, got 32 tri"));
  EXPECT_THAT(refusal([] { return points_of_mesh(test::block(Point(0.01, 0.01, 0.01)).inside_out()); }),
              HasSubstr("must enclose a volume, got -"));
  test::Soup flat = test::square(0.02, 4);
  flat.add(test::square(0.02, 4).inside_out());
  EXPECT_THAT(refusal([&] { return points_of_mesh(flat); }), HasSubstr("must"));
  EXPECT_THAT(refusal([] { return points_of_mesh(test::ball(0.02, 20), 1e-5); }), HasSubstr("a larger spacing_m"));
  EXPECT_THAT(refusal([] { return points_of_mesh(test::ball(0.02, 400)); }),
              HasSubstr("at most 250000 triangles, got"));
  const config::Values cube{{"center_m", Point(0, 0, 0)}, {"size_m", Point(0.1, 0.1, 0.1)}};
  EXPECT_THAT(refusal([&] { return points_of("box", cube, 1e-9); }), HasSubstr("more than 10000"));
  EXPECT_EQ(refusal([&] { return points_of("torus", cube, 1e-3); }),
            "a part of a tool must be one of: box, capsule, cylinder, mesh, sphere, got 'torus'");
}

}  // namespace
}  // namespace forcebound::scene
