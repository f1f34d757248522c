#include "forcebound/scene/geometry/decimate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "forcebound/server/environment/mesh_file.hpp"
#include "tests/support/meshes.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::scene {
namespace {

using test::ball;
using test::block;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kRadius_m = 0.05;

/// Vertices less edges plus faces: 2 for each ball, less 2 for each handle.
int euler_number(const MeshReport& report) {
  return static_cast<int>(report.vertices) - static_cast<int>(report.triangles / 2);
}

/// Whole collapses take two triangles each.
void expect_share(const TriangleMesh& coarse, const TriangleMesh& fine, double share) {
  const double wanted = share * static_cast<double>(fine.triangles().size());
  EXPECT_NEAR(static_cast<double>(coarse.triangles().size()), wanted, 2);
}

void expect_intact(const TriangleMesh& coarse, const TriangleMesh& fine) {
  EXPECT_TRUE(coarse.report().closed()) << to_text(coarse.report());
  EXPECT_EQ(coarse.report().slivers, 0U);
  EXPECT_EQ(coarse.report().welded_vertices, 0U);
  EXPECT_EQ(coarse.report().duplicate_triangles, 0U);
  EXPECT_EQ(euler_number(coarse.report()), euler_number(fine.report()));
}

/// A torus's surface around the z axis.
test::Soup ring(double major_m, double minor_m, std::uint32_t rows) {
  test::Soup soup;
  for (std::uint32_t j = 0; j < 2 * rows; ++j) {
    for (std::uint32_t i = 0; i < rows; ++i) {
      const double around = 2 * std::numbers::pi * j / (2 * rows);
      const double about = 2 * std::numbers::pi * i / rows;
      const double out_m = major_m + minor_m * std::cos(about);
      soup.vertices.emplace_back(out_m * std::cos(around), out_m * std::sin(around), minor_m * std::sin(about));
    }
  }
  const auto at = [&](std::uint32_t j, std::uint32_t i) { return j % (2 * rows) * rows + i % rows; };
  for (std::uint32_t j = 0; j < 2 * rows; ++j) {
    for (std::uint32_t i = 0; i < rows; ++i) soup.add_quad(at(j, i), at(j + 1, i), at(j + 1, i + 1), at(j, i + 1));
  }
  return soup;
}

TEST(Decimated, BallStaysAsRoundAsItsTrianglesAllow) {
  const TriangleMesh fine = ball(kRadius_m, 40).mesh();
  for (const double share : {0.5, 0.2, 0.05, 0.02}) {
    SCOPED_TRACE(share);
    const TriangleMesh coarse = decimated(fine, share);
    expect_intact(coarse, fine);
    expect_share(coarse, fine, share);
    // Of n equal triangles each has the area 4 pi r^2 / n, and an equilateral one's corners are a = sqrt(4 A / sqrt(3))
    // apart: its middle is a^2 / (6 r) below theirs. No vertex or middle is off by more than three times that.
    const double n = static_cast<double>(coarse.triangles().size());
    const double side_m2 = 4 * 4 * std::numbers::pi * kRadius_m * kRadius_m / n / std::numbers::sqrt3;
    const double bound_m = 3 * side_m2 / (6 * kRadius_m);
    for (std::size_t i = 0; i < coarse.triangles().size(); ++i) {
      const Point middle_m =
          (coarse.corner_m(i, 0) + coarse.corner_m(i, 1) + coarse.corner_m(i, 2)) / 3 + coarse.origin_m();
      EXPECT_NEAR(middle_m.norm(), kRadius_m, bound_m);
      EXPECT_NEAR((coarse.corner_m(i, 0) + coarse.origin_m()).norm(), kRadius_m, bound_m);
      EXPECT_GT(coarse.normals()[i].dot(middle_m.normalized()), 0.5) << "it points out";
    }
    EXPECT_NEAR(coarse.report().volume_m3 / fine.report().volume_m3, 1, 0.05);
  }
}

TEST(Decimated, BlockKeepsItsFacesAndCornersExactly) {
  // Each face cut into many triangles that a block does not need.
  test::Soup soup;
  const Point half_m(0.03, 0.03, 0.03);
  for (const auto& turn :
       {Eigen::AngleAxisd(0, Point::UnitX()), Eigen::AngleAxisd(std::numbers::pi / 2, Point::UnitX()),
        Eigen::AngleAxisd(std::numbers::pi, Point::UnitX()), Eigen::AngleAxisd(-std::numbers::pi / 2, Point::UnitX()),
        Eigen::AngleAxisd(std::numbers::pi / 2, Point::UnitY()),
        Eigen::AngleAxisd(-std::numbers::pi / 2, Point::UnitY())}) {
    soup.add(test::square(half_m.z(), 8).moved(turn * Eigen::Translation3d(0, 0, half_m.z())));
  }
  // What turns leave of rounding must not keep the faces' borders apart.
  for (Point& vertex : soup.vertices) vertex = (vertex * 0x1p20).array().round().matrix() * 0x1p-20;
  const TriangleMesh fine = soup.mesh();
  ASSERT_TRUE(fine.report().closed()) << to_text(fine.report());
  const TriangleMesh coarse = decimated(fine, 0.05);
  expect_intact(coarse, fine);
  expect_share(coarse, fine, 0.05);
  EXPECT_NEAR(coarse.report().volume_m3 / fine.report().volume_m3, 1, 1e-3);
  EXPECT_LT((coarse.box_m().sizes() - fine.box_m().sizes()).norm(), 1e-4);
}

TEST(Decimated, RingKeepsItsHole) {
  const TriangleMesh fine = ring(0.05, 0.02, 24).mesh();
  ASSERT_EQ(euler_number(fine.report()), 0);
  for (const double share : {0.3, 0.05, 1e-6}) {
    SCOPED_TRACE(share);
    expect_intact(decimated(fine, share), fine);
  }
  const double expected_m3 = 2 * std::numbers::pi * std::numbers::pi * 0.05 * 0.02 * 0.02;
  EXPECT_NEAR(decimated(fine, 0.1).report().volume_m3 / expected_m3, 1, 0.05);
}

TEST(Decimated, BodiesThatLieApartStayApart) {
  const Eigen::Isometry3d aside(Eigen::Translation3d(0.2, 0, 0));
  const TriangleMesh fine = ball(kRadius_m, 12).add(ball(kRadius_m, 12).moved(aside)).mesh();
  const TriangleMesh coarse = decimated(fine, 0.2);
  expect_intact(coarse, fine);
  EXPECT_EQ(euler_number(coarse.report()), 4);
}

TEST(Decimated, BallWithNothingLeftToGiveIsASolidStill) {
  const TriangleMesh fine = ball(kRadius_m, 10).mesh();
  const TriangleMesh coarse = decimated(fine, 1e-9);
  expect_intact(coarse, fine);
  EXPECT_GE(coarse.triangles().size(), 4U);
  EXPECT_LE(coarse.triangles().size(), 20U);
  EXPECT_GT(coarse.report().volume_m3, 0.1 * fine.report().volume_m3);
}

TEST(Decimated, InsideOutStaysInsideOut) {
  const TriangleMesh coarse = decimated(ball(kRadius_m, 12).inside_out().mesh(), 0.3);
  EXPECT_TRUE(coarse.report().closed());
  EXPECT_LT(coarse.report().volume_m3, 0);
}

TEST(Decimated, IsTheSameEachTimeAndNowhereElseForBeingMoved) {
  const TriangleMesh fine = ball(kRadius_m, 16).mesh();
  const TriangleMesh once = decimated(fine, 0.25);
  const TriangleMesh again = decimated(fine, 0.25);
  EXPECT_EQ(once.triangles(), again.triangles());
  EXPECT_EQ(once.vertices_m(), again.vertices_m());
  const TriangleMesh far = decimated(ball(kRadius_m, 16).mesh("far", {.offset_m = Point(100, 200, 300)}), 0.25);
  EXPECT_EQ(far.triangles(), once.triangles());
  EXPECT_LT((far.origin_m() - once.origin_m() - Point(100, 200, 300)).norm(), 1e-9);
}

TEST(Decimated, AllOfItIsTheMeshItself) {
  const TriangleMesh fine = ball(kRadius_m, 8).mesh();
  EXPECT_EQ(decimated(fine, 1).vertices_m(), fine.vertices_m());
  EXPECT_EQ(decimated(test::square(0.1, 3).mesh(), 1).triangles().size(), 18U) << "an open one needs no decimation";
}

TEST(Decimated, RefusesSharesAndMeshesThatItCannotKeepClosed) {
  const TriangleMesh fine = ball(kRadius_m, 8).mesh("ball.obj");
  for (const double share : {0.0, -0.5, 1.5, std::nan("")}) {
    EXPECT_THAT([&] { static_cast<void>(decimated(fine, share)); },
                ThrowsMessage<GeometryError>(HasSubstr("ball.obj: the share of triangles to keep must be in (0, 1]")));
  }
  EXPECT_THAT([] { static_cast<void>(decimated(test::square(0.1, 3).mesh("flat.obj"), 0.5)); },
              ThrowsMessage<GeometryError>(testing::AllOf(HasSubstr("flat.obj: "), HasSubstr("closed"))));
}

TEST(Decimated, AnyDentedBallStaysClosedAtAnyShare) {
  rc::check([] {
    const auto seed = *rc::gen::arbitrary<unsigned>();
    const double share = 0.01 * *rc::gen::inRange(1, 100);
    test::Soup soup = ball(kRadius_m, *rc::gen::inRange(3U, 14U));
    // Vertices go in and out along their way to the middle, so that there is no surface that meets itself.
    for (std::size_t i = 0; i < soup.vertices.size(); ++i) {
      soup.vertices[i] *= 1 + 0.3 * std::sin(static_cast<double>(seed % 1000 + 1) * static_cast<double>(i * i + 1));
    }
    const TriangleMesh fine = soup.mesh();
    const TriangleMesh coarse = decimated(fine, share);
    RC_ASSERT(coarse.report().closed());
    RC_ASSERT(coarse.triangles().size() <= fine.triangles().size());
    RC_ASSERT(euler_number(coarse.report()) == 2);
  });
}

TEST(Decimated, RealMeshStaysClosed) {
  const auto file = recorded_data("meshes/spot.obj");
  if (!file) GTEST_SKIP() << "no recorded data";
  const TriangleMesh fine = server::load_mesh(*file);
  for (const double share : {0.3, 0.03}) {
    const TriangleMesh coarse = decimated(fine, share);
    expect_intact(coarse, fine);
    expect_share(coarse, fine, share);
    EXPECT_NEAR(coarse.report().volume_m3 / fine.report().volume_m3, 1, share < 0.1 ? 0.1 : 0.01);
  }
}

}  // namespace
}  // namespace forcebound::scene
