#include "forcebound/scene/geometry/bvh.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "forcebound/server/environment/mesh_file.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/embree_scene.hpp"
#include "tests/support/meshes.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::scene {
namespace {

using test::shared_mesh;

constexpr unsigned kPointsSeed = 7;

/// Points in a box three times as large as the mesh.
class RandomPoints {
 public:
  explicit RandomPoints(const TriangleMesh& mesh) : reach_m_(3 * mesh.box_m().max()) {}

  Point next() {
    std::uniform_real_distribution<double> unit(-1, 1);
    return {reach_m_.x() * unit(random_), reach_m_.y() * unit(random_), reach_m_.z() * unit(random_)};
  }

 private:
  std::mt19937 random_{kPointsSeed};
  Point reach_m_;
};

void expect_what_embree_finds(const std::shared_ptr<const TriangleMesh>& mesh, int questions) {
  SCOPED_TRACE(mesh->name() + ", seed " + std::to_string(kPointsSeed));
  const Bvh bvh(mesh);
  const test::EmbreeScene embree(*mesh);
  RandomPoints points(*mesh);
  for (int i = 0; i < questions; ++i) {
    const Point from_m = points.next();
    const auto nearest = bvh.nearest(from_m);
    ASSERT_TRUE(nearest);
    EXPECT_NEAR(nearest->distance_m, embree.nearest_distance_m(from_m), 1e-6 * mesh->size_m()) << i;
    EXPECT_NEAR((nearest->point_m - from_m).norm(), nearest->distance_m, 1e-12 * mesh->size_m()) << i;
  }
}

TEST(Bvh, FindsWhatEmbreeFindsOnARealMesh) {
  const auto path = recorded_data("meshes/spot.obj");
  if (!path) GTEST_SKIP() << "no meshes/spot.obj in FORCEBOUND_DATA";
  expect_what_embree_finds(std::make_shared<const TriangleMesh>(server::load_mesh(path->string())), 20000);
}

TEST(Bvh, FindsWhatEmbreeFindsOnMadeMeshes) {
  expect_what_embree_finds(shared_mesh(test::ball(1, 60)), 10000);
  expect_what_embree_finds(shared_mesh(test::block({1, 2, 3}).moved(test::askew())), 10000);
  expect_what_embree_finds(shared_mesh(test::square(1, 40).add(test::ball(0.4, 20))), 10000);
  expect_what_embree_finds(shared_mesh(test::block({1, 1, 1e-4})), 10000);
}

TEST(Bvh, AgreesWithASearchOverAllTriangles) {
  const auto mesh = shared_mesh(test::ball(1, 16).moved(test::askew()));
  const Bvh bvh(mesh);
  RandomPoints points(*mesh);
  for (int i = 0; i < 2000; ++i) {
    const Point p = points.next();
    double least_m = std::numeric_limits<double>::infinity();
    std::set<std::uint32_t> within;
    for (std::uint32_t t = 0; t < mesh->triangles().size(); ++t) {
      const auto on = nearest_on_triangle(p, mesh->corner_m(t, 0), mesh->corner_m(t, 1), mesh->corner_m(t, 2));
      least_m = std::min(least_m, (on.point_m - p).norm());
      if ((on.point_m - p).norm() <= 1) within.insert(t);
    }
    EXPECT_EQ(bvh.nearest(p)->distance_m, least_m);
    EXPECT_EQ(bvh.nearest(p, 0.99 * least_m), std::nullopt);
    EXPECT_TRUE(bvh.nearest(p, 1.01 * least_m));
    std::set<std::uint32_t> about;
    bvh.for_each_about(Bounds(Point(p - Point::Ones()), Point(p + Point::Ones())),
                       [&](std::uint32_t place) { about.insert(bvh.order()[place]); });
    EXPECT_TRUE(std::includes(about.begin(), about.end(), within.begin(), within.end()));
  }
}

TEST(Bvh, VisitsEveryTriangleThatASegmentMeetsAtItsEndsAndInTheSidesOfBoxes) {
  const auto mesh = shared_mesh(test::square(1, 8));
  const Bvh bvh(mesh);
  for (const Segment& segment : {Segment{{0.3, 0.2, 1}, {0, 0, -1}}, Segment{{0.3, 0.2, 0}, {0, 0, 1}},
                                 Segment{{0.25, -0.5, 1}, {0, 0, -2}}, Segment{{1, 1, 1}, {0, 0, -2}}}) {
    const Point met_m(segment.from_m.x(), segment.from_m.y(), 0);
    std::set<std::uint32_t> there;
    for (std::uint32_t t = 0; t < mesh->triangles().size(); ++t) {
      if (bvh.nearest_on(t, met_m).point_m == met_m) there.insert(t);
    }
    std::set<std::uint32_t> visited;
    bvh.for_each_along(segment, 1, [&](std::uint32_t place, double until) {
      visited.insert(bvh.order()[place]);
      return until;
    });
    EXPECT_FALSE(there.empty());
    EXPECT_TRUE(std::includes(visited.begin(), visited.end(), there.begin(), there.end()));
  }
}

TEST(Bvh, HoldsMeshesWhoseTrianglesLieOnTopOfEachOther) {
  test::Soup soup;
  for (int i = 0; i < 100; ++i) {
    test::Soup one = test::square(1, 1);
    one.vertices[0].z() = 1e-9 * i;
    soup.add(one);
  }
  const Bvh bvh(shared_mesh(soup));
  EXPECT_EQ(bvh.order().size(), bvh.mesh().triangles().size());
  EXPECT_NEAR(bvh.nearest({0.1, 0.2, 1})->distance_m, 1, 1e-6);
}

TEST(Bvh, VisitsNoMoreThanItsBudget) {
  // From its middle, all of a ball is equally near.
  const Bvh bvh(shared_mesh(test::ball(1, 60)));
  {
    const SearchBudget budget(1000);
    (void)bvh.nearest(Point::Zero());
    EXPECT_TRUE(SearchBudget::exhausted());
    EXPECT_FALSE(bvh.nearest(Point::Zero())) << "nothing is left";
    std::size_t visited = 0;
    bvh.for_each_about(bvh.mesh().box_m(), [&](std::uint32_t) { ++visited; });
    EXPECT_EQ(visited, 0U);
  }
  EXPECT_FALSE(SearchBudget::exhausted());
  EXPECT_TRUE(bvh.nearest(Point::Zero()));
  const SearchBudget budget(1000);
  EXPECT_TRUE(bvh.nearest({0, 0, 1.1}));
  EXPECT_FALSE(SearchBudget::exhausted());
}

TEST(Bvh, AnswersDoNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const Bvh bvh(shared_mesh(test::ball(1, 30)));
  std::size_t found = 0;
  const test::AllocationGuard guard;
  bvh.for_each_along({{2, 0.1, 0.2}, {-4, 0, 0}}, 1, [&](std::uint32_t, double until) {
    ++found;
    return until;
  });
  found += bvh.nearest({2, 0.1, 0.2}) ? 1 : 0;
  bvh.for_each_about({Point(0.9, -0.1, -0.1), Point(1.1, 0.1, 0.1)}, [&](std::uint32_t) { ++found; });
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_GT(found, 2U);
}

}  // namespace
}  // namespace forcebound::scene
