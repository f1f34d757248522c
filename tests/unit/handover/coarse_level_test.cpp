#include "forcebound/handover/coarse_level.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "forcebound/server/environment/mesh_file.hpp"
#include "tests/tools/data/recorded_data.hpp"
#include "tests/unit/handover/handed_over.hpp"

namespace forcebound::handover {
namespace {

using testing::HasSubstr;

/// Of 30 mm, with bumps.
test::Soup bumpy_ball(std::uint32_t rows, double bump_m) {
  constexpr double kBumps = 12;
  test::Soup soup = test::ball(0.03, rows);
  for (Point& vertex : soup.vertices) {
    const double turn = std::atan2(vertex.y(), vertex.x());
    vertex *= 1 + bump_m / 0.03 * std::sin(kBumps * turn) * std::sin(kBumps * std::acos(vertex.z() / 0.03));
  }
  return soup;
}

/// Each triangle cut into four, `times` times over.
test::Soup refined(test::Soup soup, int times) {
  for (int i = 0; i < times; ++i) {
    std::vector<test::Triangle> parts;
    for (const auto& [a, b, c] : soup.triangles) {
      const auto first = static_cast<std::uint32_t>(soup.vertices.size());
      for (const auto& [p, q] : {std::pair{a, b}, {b, c}, {c, a}})
        soup.vertices.emplace_back(0.5 * (soup.vertices[p] + soup.vertices[q]));
      for (const test::Triangle& part : {test::Triangle{a, first, first + 2},
                                         {first, b, first + 1},
                                         {first + 2, first + 1, c},
                                         {first, first + 1, first + 2}}) {
        parts.push_back(part);
      }
    }
    soup.triangles = std::move(parts);
  }
  return soup;
}

/// Of points drawn on one surface, the distance from the other of the one that is the furthest.
double drawn_error_m(const scene::TriangleMesh& from, const scene::Bvh& to) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> share(0, 1);
  const Point shift = from.origin_m() - to.mesh().origin_m();
  double most_m = 0;
  for (int i = 0; i < 100'000; ++i) {
    const std::size_t triangle = random() % from.triangles().size();
    double a = share(random);
    double b = share(random);
    if (a + b > 1) {
      a = 1 - a;
      b = 1 - b;
    }
    const Point& corner = from.corner_m(triangle, 0);
    const Point drawn = corner + a * (from.corner_m(triangle, 1) - corner) + b * (from.corner_m(triangle, 2) - corner);
    most_m = std::max(most_m, to.nearest(drawn + shift)->distance_m);
  }
  return most_m;
}

void expect_it_lies_nowhere_further_than_it_says(const std::shared_ptr<const scene::TriangleMesh>& mesh) {
  const scene::Bvh tree(mesh);
  const auto coarse = coarse_level_of(tree);
  ASSERT_TRUE(coarse);
  EXPECT_TRUE(coarse->mesh->report().closed());
  EXPECT_LE(4 * coarse->mesh->triangles().size(), mesh->triangles().size());
  EXPECT_LE(coarse->error_m, kCoarseErrorMost_m);
  const double drawn_m = std::max(drawn_error_m(*mesh, scene::Bvh(coarse->mesh)), drawn_error_m(*coarse->mesh, tree));
  EXPECT_LE(drawn_m, coarse->error_m);
  EXPECT_LE(coarse->error_m, std::max(2 * drawn_m, 0x1p-7 * mesh->size_m())) << "it says much more than it is";
}

TEST(ACoarseLevel, LiesNowhereFurtherFromItsMeshThanItSays) {
  expect_it_lies_nowhere_further_than_it_says(test::shared_mesh(bumpy_ball(80, 3e-4), {.offset_m = {0.1, 0.2, 0}}));
  expect_it_lies_nowhere_further_than_it_says(test::shared_mesh(test::ball(0.05, 60)));
  expect_it_lies_nowhere_further_than_it_says(test::shared_mesh(refined(test::block(Point(0.05, 0.02, 0.004)), 5)));
}

TEST(ACoarseLevel, LiesNowhereFurtherFromAScannedAnimalThanItSays) {
  const auto path = recorded_data("meshes/spot.obj");
  if (!path) GTEST_SKIP() << "no meshes/spot.obj in FORCEBOUND_DATA";
  const scene::TriangleMesh spot = server::load_mesh(path->string(), {.scale = 0.05});
  expect_it_lies_nowhere_further_than_it_says(test::shared_mesh(refined({spot.vertices_m(), spot.triangles()}, 1)));
}

TEST(ACoarseLevel, IsNotMadeOfASmallMeshNorOfAnOpenOneNorWhereItWouldLieFarOff) {
  EXPECT_FALSE(coarse_level_of(scene::Bvh(test::shared_mesh(test::ball(0.03, 40)))));
  EXPECT_FALSE(coarse_level_of(scene::Bvh(test::shared_mesh(test::square(0.03, 80)))));
  EXPECT_FALSE(coarse_level_of(scene::Bvh(test::shared_mesh(bumpy_ball(60, 3e-4), {.scale = 100}))));
}

TEST(ACoarseLevel, HasMoreTrianglesWhereFewLieTooFarOff) {
  std::set<std::size_t> triangles;
  for (const double scale : {1.0, 2.0, 2.5, 3.0}) {
    const auto level = coarse_level_of(scene::Bvh(test::shared_mesh(bumpy_ball(64, 6e-4), {.scale = scale})));
    if (level) triangles.insert(level->mesh->triangles().size());
  }
  EXPECT_THAT(triangles, testing::ElementsAre(2000, 4000));
}

TEST(ACoarseLevel, HasAnErrorThatIsRightForBoxesInOneAnother) {
  const scene::Bvh inner(test::shared_mesh(test::block(Point(0.02, 0.02, 0.02))));
  const scene::Bvh outer(test::shared_mesh(test::block(Point(0.021, 0.021, 0.021))));
  const double corner_m = std::numbers::sqrt3 * 1e-3;
  for (const auto& [one, other] : {std::pair{&inner, &outer}, {&outer, &inner}}) {
    EXPECT_GE(error_between_m(*one, *other), corner_m);
    EXPECT_LE(error_between_m(*one, *other), 2 * corner_m);
  }
}

TEST(ACoarseLevel, IsHeldToItsErrorAsSoonAsSomethingOfItsMeshIsThere) {
  const scene::Bvh full(test::shared_mesh(test::ball(0.03, 40)));
  const scene::Bvh smaller(test::shared_mesh(test::ball(0.0295, 20)));
  EXPECT_EQ(refusal_of([&] { check_error(smaller, 1e-3, full, true); }), "accepted");
  EXPECT_THAT(refusal_of([&] { check_error(smaller, 4e-4, full, false); }),
              HasSubstr("within 0.0004 m of it, but lies 0.000681 m off"));
  // Where it lies outside alone, all of the mesh shows it.
  const test::Soup with_a_spur =
      test::ball(0.03, 20).add(test::ball(0.001, 4).moved(Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.04))));
  const scene::Bvh spurred(test::shared_mesh(with_a_spur));
  EXPECT_EQ(refusal_of([&] { check_error(spurred, 5e-4, full, false); }), "accepted");
  EXPECT_THAT(refusal_of([&] { check_error(spurred, 5e-4, full, true); }), HasSubstr("m off"));
}

}  // namespace
}  // namespace forcebound::handover
