#include "forcebound/scene/geometry/god_object.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <type_traits>

#include "forcebound/server/environment/mesh_file.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/follower.hpp"
#include "tests/support/special_numbers.hpp"
#include "tests/support/winding.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::scene {
namespace {

using test::Follower;
using test::kNaN;
using test::spring_force;

static_assert(std::is_trivially_copyable_v<Proxy> && std::is_trivially_default_constructible_v<Proxy>);
static_assert(sizeof(Proxy) % 8 == 0 && alignof(Proxy) <= 8);

TEST(GodObject, IsAtItsGoalWhereNothingIsInTheWay) {
  Follower follower(test::ball(1, 20));
  for (const Point& goal : {Point(2, 0, 0), Point(1.1, 1.1, 1.1), Point(1e9, 0, 0), Point(1.001, 0, 0)}) {
    EXPECT_EQ(follower.to(goal).penetration_m, 0);
    EXPECT_EQ(follower.at_m(), goal);
  }
}

TEST(GodObject, IsFirstPutToItsGoalEvenInside) {
  Follower follower(test::ball(1, 20));
  EXPECT_EQ(follower.to({0.5, 0, 0}).penetration_m, 0);
  EXPECT_EQ(follower.to({2, 0, 0}).penetration_m, 0) << "from behind, a surface does not hold";
  EXPECT_NEAR(follower.to({0.5, 0, 0}).penetration_m, 0.5, 0.01);
}

TEST(GodObject, SlidesOverAPlaneOfTrianglesAsOverAPlane) {
  for (const auto& motion : {Eigen::Isometry3d::Identity(), test::askew()}) {
    Follower follower(test::square(1, 20).moved(motion));
    const Point normal = motion.linear().col(2);
    (void)follower.to(motion * Point(0, 0, 1));
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < 5000; ++i) {
      const double depth_m = std::pow(10, -3 + 2.5 * unit(random));
      // Every second goal lies under an edge or a vertex.
      Point goal(0.9 * unit(random), 0.9 * unit(random), -depth_m);
      if (i % 2 == 0) goal.x() = std::round(goal.x() * 10) / 10;
      if (i % 4 == 0) goal.y() = std::round(goal.y() * 10) / 10;
      const SurfacePoint found = follower.to(motion * goal);
      ASSERT_LT((spring_force(found) - depth_m * normal).norm(), 1e-9 * depth_m + 2e-15) << "tick " << i;
    }
  }
}

TEST(GodObject, FeelsNoEdgeWhileItCreepsOverThem) {
  Follower follower(test::square(1, 20).moved(test::askew()));
  const Point normal = test::askew().linear().col(2);
  (void)follower.to(test::askew() * Point(-0.5, 0.3, 0.1));
  constexpr double kDepth_m = 0.01;
  for (int i = 0; i < 20000; ++i) {
    const SurfacePoint found = follower.to(test::askew() * Point(-0.5 + 5e-5 * i, 0.3 + 1e-5 * i, -kDepth_m));
    ASSERT_LT((spring_force(found) - kDepth_m * normal).norm(), 1e-9 * kDepth_m) << "tick " << i;
  }
}

TEST(GodObject, FollowsABallOfTrianglesWithinTheirOwnError) {
  constexpr std::uint32_t kRows = 40;
  Follower follower(test::ball(1, kRows).moved(test::askew()));
  // The middle of a facet is this much nearer to the centre than its corners, and its normal off by such an angle.
  const double half_angle = std::numbers::pi / kRows / std::numbers::sqrt2;
  const double sagitta_m = 1 - std::cos(half_angle);
  constexpr double kDepth_m = 0.05;
  // Under a facet it gets deeper by the way's share along the normal; from one to the next, d becomes d cos(angle).
  const double step_m = 1.05e-3 * 1.5 * half_angle + kDepth_m * (1 - std::cos(std::numbers::pi / kRows));
  (void)follower.to(Point(0, 0, 2));
  double before_m = follower.to({0, 0, 1 - kDepth_m}).penetration_m;
  for (int i = 0; i < 20000; ++i) {
    const double turn = 1e-3 * i;
    const Point out(std::sin(turn) * std::cos(0.3 * turn), std::sin(turn) * std::sin(0.3 * turn), std::cos(turn));
    const SurfacePoint found = follower.to((1 - kDepth_m) * out);
    ASSERT_NEAR(found.penetration_m, kDepth_m, 1.1 * sagitta_m) << i;
    ASSERT_LT(std::acos(std::min(1.0, found.normal.dot(out))), 1.5 * half_angle) << i;
    ASSERT_LT(std::abs(found.penetration_m - before_m), step_m) << "a bump at " << i;
    before_m = found.penetration_m;
  }
}

TEST(GodObject, StopsInConcaveEdgesAndCorners) {
  const auto motion = test::askew();
  Follower follower(test::block({1, 1, 1}).inside_out().moved(motion));
  (void)follower.to(motion * Point(0, 0, 0));
  const auto expect_at = [&](const Point& goal, const Point& held) {
    const SurfacePoint found = follower.to(motion * goal);
    EXPECT_LT((motion.inverse() * follower.at_m() - held).norm(), 1e-12) << goal.transpose();
    EXPECT_NEAR(found.penetration_m, (held - goal).norm(), 1e-12);
  };
  expect_at({1.5, 0.2, 0.3}, {1, 0.2, 0.3});
  expect_at({1.5, 1.2, 0.3}, {1, 1, 0.3});
  expect_at({1.5, 1.2, 1.3}, {1, 1, 1});
  expect_at({1.5, 1.2, 1.3}, {1, 1, 1});
  expect_at({1.5, 1.2, -0.9}, {1, 1, -0.9});
  expect_at({-3, -1.2, -1.9}, {-1, -1, -1});
  expect_at({-3, 0.5, -1.9}, {-1, 0.5, -1});
  expect_at({0.1, 0.5, -0.9}, {0.1, 0.5, -0.9});
}

TEST(GodObject, FindsTheNearestPointInAConeOfManyPlanes) {
  // The inside of a cone of 40 triangles, pointing down: 40 planes meet at its tip.
  test::Soup soup;
  soup.vertices.emplace_back(0, 0, 0);
  for (int i = 0; i < 40; ++i) {
    const double turn = 2 * std::numbers::pi * i / 40;
    soup.vertices.emplace_back(std::cos(turn), std::sin(turn), 1);
  }
  for (std::uint32_t i = 0; i < 40; ++i) soup.triangles.push_back({0, 1 + i, 1 + (i + 1) % 40});
  Follower follower(soup.moved(test::askew()));
  const auto motion = test::askew();
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1, 1);
  (void)follower.to(motion * Point(0, 0, 0.5));
  for (int i = 0; i < 2000; ++i) {
    const Point goal(0.5 * unit(random), 0.5 * unit(random), -0.2 + 0.4 * unit(random));
    (void)follower.to(motion * goal);
    const Point at = motion.inverse() * follower.at_m();
    EXPECT_GT(at.z() - std::hypot(at.x(), at.y()), -1e-9) << "went through at " << goal.transpose();
    // Below the cone of the normals it is held by the tip alone.
    if (goal.z() < -1.01 * std::hypot(goal.x(), goal.y())) {
      EXPECT_LT(at.norm(), 1e-9) << goal.transpose();
    }
  }
}

TEST(GodObject, FindsTheNearestPointInAWedgeOfAnyAngle) {
  const auto motion = test::askew();
  for (const double half_angle : {1e-3, 0.01, 0.1, 0.7, 1.5, 1.57, 1.570796, 1.5707963}) {
    SCOPED_TRACE("half angle " + std::to_string(half_angle));
    const Point wall = Point(std::sin(half_angle), 0, std::cos(half_angle));
    test::Soup soup;
    for (const double side : {1.0, -1.0}) {
      const auto first = static_cast<std::uint32_t>(soup.vertices.size());
      for (const auto& [along, up] : {std::pair(-1, 0), std::pair(-1, 1), std::pair(1, 1), std::pair(1, 0)}) {
        soup.vertices.emplace_back(side * up * wall.x(), along, up * wall.z());
      }
      if (side > 0) soup.add_quad(first, first + 1, first + 2, first + 3);
      if (side < 0) soup.add_quad(first, first + 3, first + 2, first + 1);
    }
    Follower follower(soup.moved(motion));
    std::mt19937 random(6);
    std::uniform_real_distribution<double> unit(-1, 1);
    (void)follower.to(motion * Point(0, 0, 2));
    for (int i = 0; i < 3000; ++i) {
      const Point goal(0.1 * wall.x() * unit(random), 0.9 * unit(random), wall.z() * (0.2 * unit(random) - 0.1));
      (void)follower.to(motion * goal);
      // Seen from the side with positive x: `out` of the wedge through its wall, `up` along it.
      const double x = std::abs(goal.x());
      const double out = x * wall.z() - goal.z() * wall.x();
      const double up = x * wall.x() + goal.z() * wall.z();
      const Point held = std::max(0.0, up) * wall;
      const Point expected = out <= 0 ? goal : Point(std::copysign(held.x(), goal.x()), goal.y(), held.z());
      ASSERT_LT((motion.inverse() * follower.at_m() - expected).norm(), 1e-10)
          << "tick " << i << ": " << goal.transpose();
    }
  }
}

/// Triangles around the origin; `ring` are their corners, anticlockwise from above.
test::Soup fan(const std::vector<Point>& ring) {
  test::Soup soup;
  soup.vertices.emplace_back(0, 0, 0);
  soup.vertices.insert(soup.vertices.end(), ring.begin(), ring.end());
  const auto corners = static_cast<std::uint32_t>(ring.size());
  for (std::uint32_t i = 0; i < corners; ++i) soup.triangles.push_back({0, 1 + i, 1 + (i + 1) % corners});
  return soup;
}

Point on_ring(double turn, double height) { return {std::cos(turn), std::sin(turn), height}; }

/// Moves to the goal until nothing changes any more, since a fall takes several motions.
SurfacePoint settle(Follower& follower, const Point& goal) {
  SurfacePoint found = follower.to(goal);
  for (int i = 0; i < 2000; ++i) {
    const Point before = follower.at_m();
    found = follower.to(goal);
    if ((follower.at_m() - before).norm() < 1e-13) return found;
  }
  ADD_FAILURE() << "never comes to rest";
  return found;
}

/// How much nearer to the goal a triangle that the god object touches would let it.
double nearer_about_m(const Follower& follower, const Point& goal) {
  const TriangleMesh& mesh = follower.object().bvh().mesh();
  const Point at = follower.at_m() - mesh.origin_m();
  const Point to = goal - mesh.origin_m();
  double best_m = 0;
  for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
    const auto nearest = [&](const Point& p) {
      return nearest_on_triangle(p, mesh.corner_m(i, 0), mesh.corner_m(i, 1), mesh.corner_m(i, 2)).point_m;
    };
    if ((nearest(at) - at).norm() > 1e-9 * mesh.size_m()) continue;
    best_m = std::max(best_m, (at - to).norm() - (nearest(to) - to).norm());
  }
  return best_m;
}

TEST(GodObject, FindsTheValleysOfAVertexWhereConvexAndConcaveEdgesAlternate) {
  // Six triangles, whose edges are ridges and valleys by turns. From the middle, a valley leads nearer to a goal below.
  std::vector<Point> ring;
  ring.reserve(6);
  for (int i = 0; i < 6; ++i) ring.push_back(on_ring(i * std::numbers::pi / 3, i % 2 == 0 ? 0.5 : -0.5));
  const auto motion = test::askew();
  constexpr double kDepth = 0.3;
  const double in_valley = kDepth / std::hypot(1, 0.5);
  for (const Point& start : {Point(0, 0, 0.5), Point(1e-6, 0, 1e-6), Point(0, 1e-6, 1e-6), Point(-1e-6, 1e-6, 1e-6)}) {
    Follower follower(fan(ring).moved(motion));
    (void)follower.to(motion * start);
    (void)follower.to(motion * Point(start.x(), start.y(), 0));
    const SurfacePoint found = settle(follower, motion * Point(0, 0, -kDepth));
    EXPECT_NEAR(found.penetration_m, in_valley, 1e-10) << "started at " << start.transpose();
  }
}

TEST(GodObject, FindsTheValleysOfAVertexOfManyTriangles) {
  std::vector<Point> ring;
  ring.reserve(60);
  for (int i = 0; i < 60; ++i)
    ring.push_back(on_ring(i * std::numbers::pi / 30, 0.5 * std::cos(i * std::numbers::pi / 10)));
  const auto motion = test::askew();
  Follower follower(fan(ring).moved(motion));
  (void)follower.to(motion * Point(0, 0, 0.5));
  (void)follower.to(motion * Point(0, 0, 0));
  EXPECT_NEAR(settle(follower, motion * Point(0, 0, -0.3)).penetration_m, 0.3 / std::hypot(1, 0.5), 1e-10);
}

TEST(GodObject, RestsOnAnyFanWhereNoTriangleLeadsNearer) {
  constexpr unsigned kSeed = 12;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> unit(-1, 1);
  int at_vertex = 0;
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", fan " + std::to_string(i));
    const int corners = 4 + i % 7;
    std::vector<Point> ring;
    ring.reserve(static_cast<std::size_t>(corners));
    for (int k = 0; k < corners; ++k) {
      ring.push_back(
          on_ring((k + 0.3 * unit(random)) * 2 * std::numbers::pi / corners, 0.2 * (i % 2) + 0.5 * unit(random)));
    }
    const test::Soup soup = fan(ring).moved(test::askew());
    const Point goal = test::askew() * Point(0.1 * unit(random), 0.1 * unit(random), -0.3 - 0.1 * unit(random));
    Follower follower(soup);
    (void)follower.to(test::askew() * Point(0, 0, 1));
    const SurfacePoint found = settle(follower, goal);
    ASSERT_GT(found.penetration_m, 0.05);
    ASSERT_LT(nearer_about_m(follower, goal), 1e-9);
    at_vertex += (follower.at_m() - test::askew() * Point(0, 0, 0)).norm() < 1e-9 ? 1 : 0;
    Follower beside(soup);
    (void)beside.to(follower.at_m() +
                    1e-6 * (test::askew().linear() * Point(0.1 * unit(random), 0.1 * unit(random), 1)));
    ASSERT_NEAR(settle(beside, goal).penetration_m, found.penetration_m, 1e-8);
    Follower both(soup, {.two_sided = true});
    (void)both.to(test::askew() * Point(0, 0, 1));
    ASSERT_GT(settle(both, goal).penetration_m, 0.05) << "went through, felt from both sides";
  }
  EXPECT_GT(at_vertex, 100) << "hardly any fan held it at its vertex";
}

TEST(GodObject, RestsOnARoughBallWhereNoTriangleLeadsNearer) {
  for (const bool two_sided : {false, true}) {
    Follower follower(test::rough(test::ball(1, 16), 0.015, 7).moved(test::askew()), {.two_sided = two_sided});
    (void)follower.to({0, 0, 2});
    for (int i = 0; i < 1500; ++i) {
      SCOPED_TRACE("goal " + std::to_string(i) + (two_sided ? ", two-sided" : ""));
      const double turn = 0.01 * i;
      const Point out(std::cos(0.37 * turn) * std::cos(turn), std::cos(0.37 * turn) * std::sin(turn),
                      std::sin(0.37 * turn));
      const Point goal = (0.8 + 0.1 * std::sin(3.1 * turn)) * out;
      (void)settle(follower, goal);
      ASSERT_LT(nearer_about_m(follower, goal), 1e-9);
      ASSERT_GT(follower.at_m().norm(), 0.8) << "went through";
    }
  }
}

TEST(GodObject, HoldsOnAMeshThatPassesThroughItself) {
  // At the poles the vertices are nearer to each other than they are moved.
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Follower follower(test::rough(test::ball(1, 16), 0.05, seed).moved(test::askew()), {.two_sided = seed % 2 == 0});
    (void)follower.to({0, 0, 2});
    for (int i = 0; i < 4000; ++i) {
      const double turn = 0.005 * i;
      const Point out(std::cos(0.37 * turn) * std::cos(turn), std::cos(0.37 * turn) * std::sin(turn),
                      std::sin(0.37 * turn));
      for (int again = 0; again < 10; ++again) (void)follower.to((0.8 + 0.1 * std::sin(3.1 * turn)) * out);
      ASSERT_GT(follower.at_m().norm(), 0.83) << "went through at goal " << i << ", seed " << seed;
    }
  }
}

TEST(GodObject, FallsOverSeveralMotionsFromARidgeThatEnds) {
  Follower follower(test::square(1, 4));
  constexpr double kDepth_m = 0.5;
  constexpr double kStep_m = 1e-3;
  (void)follower.to({0.9, 0, 0.1});
  (void)follower.to({0.9, 0, -kDepth_m});
  Point before = follower.at_m();
  SurfacePoint found = follower.to({1 - kStep_m, 0, -kDepth_m});
  EXPECT_NEAR(found.penetration_m, kDepth_m, 1e-12) << "to the rim the plane holds";
  for (int i = 0; i < 200 && found.penetration_m > 0; ++i) {
    const double depth_m = found.penetration_m;
    before = follower.at_m();
    const double gone_m = i == 0 ? 2 * kStep_m : 0;
    found = follower.to({1 + kStep_m, 0, -kDepth_m});
    ASSERT_LT(found.penetration_m, depth_m) << "each motion goes on";
    ASSERT_LE((follower.at_m() - before).norm(),
              4 * gone_m + (depth_m + gone_m) / 8 + follower.object().bvh().mesh().size_m() / 1024 + 1e-12);
  }
  EXPECT_EQ(found.penetration_m, 0) << "it arrives";
}

TEST(GodObject, StaysPutWhileItsGoalDoes) {
  Follower follower(test::ball(1, 30).moved(test::askew()));
  (void)follower.to({0, 0, 2});
  for (const Point& goal : {Point(0.1, 0.2, 0.5), Point(0.3, -0.5, 0.1), Point(0.01, 0, 0.99)}) {
    const SurfacePoint first = follower.to(goal);
    for (int i = 0; i < 100; ++i) {
      const SurfacePoint again = follower.to(goal);
      ASSERT_LT((spring_force(again) - spring_force(first)).norm(), 1e-14);
    }
  }
}

TEST(GodObject, HoldsFromBothSidesIfAskedTo) {
  Follower follower(test::square(1, 4), {.two_sided = true});
  (void)follower.to({0.1, 0.2, 0.5});
  EXPECT_NEAR(follower.to({0.1, 0.2, -0.01}).penetration_m, 0.01, 3e-11);
  EXPECT_EQ(follower.to({0.1, 0.2, 0.01}).penetration_m, 0) << "releases the side that it is on";
  (void)follower.to({3, 0, 0.01});
  (void)follower.to({3, 0, -0.5});
  (void)follower.to({0.1, 0.2, -0.5});
  const SurfacePoint below = follower.to({0.1, 0.2, 0.01});
  EXPECT_NEAR(below.penetration_m, 0.01, 3e-11);
  EXPECT_LT((below.normal - Point(0, 0, -1)).norm(), 1e-12);
  EXPECT_EQ(follower.to({0.1, 0.2, -0.01}).penetration_m, 0);
}

TEST(GodObject, TurnsRoundTheRimOfAnOpenMesh) {
  Follower follower(test::square(1, 4));
  (void)follower.to({0.9, 0, 0.5});
  EXPECT_NEAR(follower.to({0.95, 0, -0.1}).penetration_m, 0.1, 1e-12);
  EXPECT_EQ(follower.to({1.05, 0, -0.1}).penetration_m, 0);
  EXPECT_EQ(follower.to({0.5, 0, -0.1}).penetration_m, 0);
  EXPECT_EQ(follower.to({0.5, 0, 0.1}).penetration_m, 0) << "from behind it is not there";
}

TEST(GodObject, IgnoresGoalsThatAreNotFinite) {
  Follower follower(test::ball(1, 20));
  (void)follower.to({0, 0, 2});
  const SurfacePoint before = follower.to({0, 0, 0.9});
  const Proxy kept = follower.state();
  for (const double bad : {kNaN, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      Point goal(0, 0, 0.9);
      goal[axis] = bad;
      const SurfacePoint found = follower.to(goal);
      EXPECT_EQ(found.penetration_m, 0);
      EXPECT_TRUE(found.normal.allFinite());
      EXPECT_EQ(std::memcmp(&kept, &follower.state(), sizeof kept), 0);
    }
  }
  EXPECT_EQ(follower.to({0, 0, 0.9}).penetration_m, before.penetration_m);
  EXPECT_EQ(follower.to({0, 0, -1e300}).penetration_m, 0);
  EXPECT_EQ(follower.state().placed, 0U);
}

TEST(GodObject, NeverGetsInsideAClosedMesh) {
  const auto path = recorded_data("meshes/spot.obj");
  if (!path) GTEST_SKIP() << "no meshes/spot.obj in FORCEBOUND_DATA";
  for (const bool two_sided : {false, true}) {
    SCOPED_TRACE(two_sided ? "two-sided" : "one-sided");
    Follower follower(server::load_mesh(path->string()), {.two_sided = two_sided});
    const TriangleMesh& mesh = follower.object().bvh().mesh();
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(-1, 1);
    (void)follower.to(mesh.origin_m() + Point(3, 3, 3));
    Point goal = Point::Zero();
    int contacts = 0;
    for (int i = 0; i < 3000; ++i) {
      const double stride_m = std::pow(10, -2.5 + 2 * unit(random));
      goal += stride_m * Point(unit(random), unit(random), unit(random));
      goal = goal.cwiseMax(-0.7 * mesh.box_m().max()).cwiseMin(0.7 * mesh.box_m().max());
      const SurfacePoint found = follower.to(mesh.origin_m() + goal);
      contacts += found.penetration_m > 0 ? 1 : 0;
      // On the surface it may be as deep as rounding.
      const Point at = follower.at_m() - mesh.origin_m();
      if (follower.object().bvh().nearest(at)->distance_m < 4e-12 * mesh.size_m()) continue;
      ASSERT_LT(std::abs(test::winding(mesh, at)), 0.01) << "inside at tick " << i;
    }
    EXPECT_GT(contacts, 1000);
  }
}

TEST(GodObject, FollowDoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  Follower follower(test::ball(1, 30));
  double sum_m = 0;
  const test::AllocationGuard guard;
  for (int i = 0; i < 1000; ++i)
    sum_m += follower.to({0.9 * std::cos(0.01 * i), 0.9 * std::sin(0.01 * i), 2 - 0.01 * i}).penetration_m;
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_GT(sum_m, 0);
}

}  // namespace
}  // namespace forcebound::scene
