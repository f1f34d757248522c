// Meshes that are felt from both sides: the god object stays on its side of the surface, and nothing holds it where the
// device is free. Sides are told from the device's path and the triangles alone, by code of this file.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/follower.hpp"
#include "tests/support/winding.hpp"

namespace forcebound::scene {
namespace {

using test::Follower;

TEST(TwoSidedMesh, LetsGoBeyondAConvexEdge) {
  Follower follower(test::block({0.01, 0.01, 0.01}).moved(Eigen::Isometry3d(Eigen::Translation3d(0.01, 0.01, -0.01))),
                    {.two_sided = true});
  EXPECT_EQ(follower.to({0.01, -0.002, -0.0198}).penetration_m, 0);
  const SurfacePoint pressed = follower.to({0.01, 0.0001, -0.0198});
  EXPECT_LT((test::spring_force(pressed) - Point(0, -0.0001, 0)).norm(), 1e-12);
  const Point below(0.01, 0.0005, -0.02003);
  EXPECT_EQ(follower.to(below).penetration_m, 0);
  EXPECT_LT((follower.at_m() - below).norm(), 1e-15);
}

TEST(TwoSidedMesh, IsNotFeltThroughAWallBeyondASharpCorner) {
  // A wall at x = 0, and on its other side triangles of any angle whose corner touches it at the origin.
  for (const double half_width : {0.3, 1e-2, 1e-4, 1e-6}) {
    SCOPED_TRACE("half width " + std::to_string(half_width));
    test::Soup soup;
    soup.vertices = {{0, -1, -1}, {0, 1, -1},          {0, 1, 1},         {0, -1, 1},
                     {0, 0, 0},   {1, -half_width, 0}, {1, half_width, 0}};
    soup.add_quad(0, 1, 2, 3);
    soup.triangles.push_back({4, 5, 6});
    Follower follower(soup, {.two_sided = true});
    (void)follower.to({-0.5, 0, 0.5});
    for (int i = 0; i <= 100; ++i) {
      const SurfacePoint found = follower.to({0.01, 0, 0.5 - 0.01 * i});
      ASSERT_LT((test::spring_force(found) - Point(-0.01, 0, 0)).norm(), 1e-10) << "tick " << i;
    }
  }
}

TEST(TwoSidedMesh, KeepsTheGodObjectOnItsSideHoweverNearTheGoalIsToEdges) {
  constexpr unsigned kSeed = 7;
  const auto motion = test::askew();
  Follower follower(test::block({1, 1, 1}).moved(motion), {.two_sided = true});
  (void)follower.to(motion * Point(3, 0, 0));
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 10000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", goal " + std::to_string(i));
    Point goal(1.4 * unit(random), 1.4 * unit(random), 1.4 * unit(random));
    for (double& along : goal) {
      const double off_m = std::copysign(std::pow(10, -9.5 + 4.5 * unit(random)), unit(random));
      if (unit(random) < 0.6) along = std::copysign(1 + off_m, along);
    }
    for (int again = 0; again < 6; ++again) (void)follower.to(motion * goal);
    const TriangleMesh& mesh = follower.object().bvh().mesh();
    ASSERT_LT(test::winding(mesh, follower.at_m() - mesh.origin_m()), 0.7);
  }
}

/// A surface to slide over, in the frame in which it is made.
struct FeltSurface {
  std::string name;
  test::Soup soup;
  std::function<int(const Point&)> side;  // 1 or -1 next to the surface; 0: neither
};

/// Two sheets that meet at a right angle along the y axis.
test::Soup two_sheets(bool agree) {
  const test::Soup sheet = test::square(0.02, 2);
  test::Soup soup = sheet.moved(Eigen::Isometry3d(Eigen::Translation3d(0.02, 0, 0)));
  const Eigen::Isometry3d upright =
      Eigen::Translation3d(0, 0, 0.02) * Eigen::AngleAxisd(std::numbers::pi / 2, Point::UnitY());
  soup.add((agree ? sheet : sheet.inside_out()).moved(upright));
  for (Point& vertex : soup.vertices) vertex = (1e6 * vertex).array().round() / 1e6;
  return soup;
}

int side_of_two_sheets(const Point& p) { return p.x() > 0 && p.z() > 0 ? 1 : -1; }

/// Closed, with a wall and a bottom of 0.5 mm.
test::Soup thin_cup() {
  constexpr std::uint32_t kColumns = 24;
  test::Soup soup;
  soup.vertices = {{0, 0, 0}, {0, 0, 0.0005}};
  for (const auto& [radius, up] : {std::pair(0.02, 0.0), {0.02, 0.03}, {0.0195, 0.03}, {0.0195, 0.0005}}) {
    for (std::uint32_t i = 0; i < kColumns; ++i) {
      const double turn = 2 * std::numbers::pi * i / kColumns;
      soup.vertices.emplace_back(radius * std::cos(turn), radius * std::sin(turn), up);
    }
  }
  const auto at = [&](std::uint32_t row, std::uint32_t i) { return 2 + row * kColumns + i % kColumns; };
  for (std::uint32_t i = 0; i < kColumns; ++i) {
    soup.triangles.push_back({0, at(0, i + 1), at(0, i)});
    soup.triangles.push_back({1, at(3, i), at(3, i + 1)});
    for (std::uint32_t row = 0; row < 3; ++row)
      soup.add_quad(at(row, i), at(row, i + 1), at(row + 1, i + 1), at(row + 1, i));
  }
  return soup;
}

constexpr int kSaddleRows = 12;

double saddle_height_m(double column, double row) {
  const double x = 0.04 * column / kSaddleRows - 0.02;
  const double y = 0.04 * row / kSaddleRows - 0.02;
  return (x * x - y * y) / 0.04;
}

test::Soup saddle() {
  test::Soup soup = test::square(0.02, kSaddleRows);
  for (Point& vertex : soup.vertices) vertex.z() = (vertex.x() * vertex.x() - vertex.y() * vertex.y()) / 0.04;
  return soup;
}

int side_of_saddle(const Point& p) {
  const double column = std::floor((p.x() + 0.02) / 0.04 * kSaddleRows);
  const double row = std::floor((p.y() + 0.02) / 0.04 * kSaddleRows);
  if (std::min(column, row) < 0 || std::max(column, row) >= kSaddleRows) return 0;
  const double u = (p.x() + 0.02) / 0.04 * kSaddleRows - column;
  const double v = (p.y() + 0.02) / 0.04 * kSaddleRows - row;
  const double near = saddle_height_m(column, row);
  const double far = saddle_height_m(column + 1, row + 1);
  const double middle = u > v ? saddle_height_m(column + 1, row) : saddle_height_m(column, row + 1);
  return p.z() > near + std::max(u, v) * (middle - near) + std::min(u, v) * (far - middle) ? 1 : -1;
}

std::vector<FeltSurface> surfaces() {
  const auto closed = [](const std::string& name, const test::Soup& soup) {
    const auto mesh = test::shared_mesh(soup);
    return FeltSurface{name, soup,
                       [mesh](const Point& p) { return test::winding(*mesh, p - mesh->origin_m()) > 0.5 ? -1 : 1; }};
  };
  return {closed("cube", test::block({0.01, 0.01, 0.01})),
          {"two sheets", two_sheets(true), side_of_two_sheets},
          {"two sheets whose normals disagree", two_sheets(false), side_of_two_sheets},
          closed("thin cup", thin_cup()),
          {"saddle", saddle(), side_of_saddle}};
}

/// Presses and slides of a hand on one surface, each from a new place. Points are in the mesh's own frame.
class Slides {
 public:
  Slides(const FeltSurface& surface, const Eigen::Isometry3d& motion)
      : surface_(surface),
        back_(motion.inverse()),
        object_(test::shared_mesh(surface.soup.moved(motion)), {.two_sided = true}) {}

  void run(unsigned seed) {
    random_.seed(seed);
    proxy_ = {};
    const std::size_t triangle = random_() % mesh().triangles().size();
    const bool exact = random_() % 2 == 0;  // places and ways along the triangle's edges, without a random digit
    const double u = exact ? 0.25 : power(-3, -0.1);
    const double v = exact ? 0.25 : uniform(0, 1 - u);
    const Point at = mesh().corner_m(triangle, 0) + u * (mesh().corner_m(triangle, 1) - mesh().corner_m(triangle, 0)) +
                     v * (mesh().corner_m(triangle, 2) - mesh().corner_m(triangle, 0));
    const Point out = (random_() % 3 == 0 ? -1 : 1) * mesh().normals()[triangle];
    free_m_ = at + power(-4, -2.7) * out;
    if (crossings(free_m_, at + 1e-7 * out) > 0 || touches(free_m_)) return;
    ++count_;
    device_m_ = free_m_;
    (void)follow();
    const double depth_m = power(-5, -2);
    move(at - depth_m * out);
    if (crossings(free_m_, device_m_) == 1) {
      EXPECT_GT(follow().penetration_m, 0) << "nothing holds";
    }
    for (std::size_t i = 0; i < 4 && !::testing::Test::HasFailure(); ++i) {
      Point way = (mesh().corner_m(triangle, (i + 1) % 3) - mesh().corner_m(triangle, i % 3)).normalized();
      if (random_() % 2 == 0) way = out.cross(way);
      if (!exact) way += uniform(-1, 1) * out.cross(way) + uniform(-0.2, 0.2) * out;
      move(device_m_ + (random_() % 2 == 0 ? -1 : 1) * power(-2.5, -1.3) * way);
    }
    move(at - depth_m * out);
  }

  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] int free() const noexcept { return free_; }

 private:
  static constexpr double kOff_m = 1e-6;  // nearer to the surface, the device counts as touching it
  static constexpr int kTicksMost = 200;

  [[nodiscard]] const TriangleMesh& mesh() const noexcept { return object_.bvh().mesh(); }
  double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(random_); }
  double power(double from, double to) { return std::pow(10, uniform(from, to)); }

  SurfacePoint follow() { return object_.follow(device_m_ + mesh().origin_m(), proxy_); }
  [[nodiscard]] static Point at_m(const Proxy& proxy) { return {proxy.x_m, proxy.y_m, proxy.z_m}; }

  void move(const Point& to_m) {
    const Point from_m = device_m_;
    const double speed_m_per_s = power(-2, -0.3);
    const int ticks = std::clamp(static_cast<int>((to_m - from_m).norm() / speed_m_per_s * 1000), 1, kTicksMost);
    for (int i = 1; i <= ticks && !::testing::Test::HasFailure(); ++i) {
      const Point before_m = at_m(proxy_);
      device_m_ = from_m + (to_m - from_m) * i / ticks;
      const SurfacePoint found = follow();
      expect_same_side(before_m, at_m(proxy_));
      if (i % 5 == 0 || i == ticks) expect_free();
      if (found.penetration_m == 0 && !touches(device_m_)) free_m_ = device_m_;
    }
  }

  /// From one tick to the next the god object may turn round a rim, or cut a convex edge, but not go through.
  void expect_same_side(const Point& before_m, const Point& now_m) const {
    if (crossings(before_m, now_m) == 0) return;
    const auto side = [&](const Point& p) { return surface_.side(back_ * (p + mesh().origin_m())); };
    if (side(before_m) * side(now_m) >= 0) return;
    EXPECT_LT(rim_distance_m(before_m), 3 * (now_m - before_m).norm() + 1e-9) << "went through";
  }

  /// Seen from where it was free last, the device is on the side that it came from. Only a fall may still be on its
  /// way.
  void expect_free() {
    if (crossings(free_m_, device_m_) > 0 || touches(device_m_)) return;
    ++free_;
    Proxy proxy = proxy_;
    double penetration_m = 1;
    for (int i = 0; i < 3000 && penetration_m > 0; ++i) {
      penetration_m = object_.follow(device_m_ + mesh().origin_m(), proxy).penetration_m;
    }
    EXPECT_EQ(penetration_m, 0) << "captured; device " << device_m_.transpose() << ", free before at "
                                << free_m_.transpose() << ", god object " << at_m(proxy).transpose();
  }

  /// Triangles that the line meets, with those whose edges it meets.
  [[nodiscard]] int crossings(const Point& from, const Point& to) const {
    int count = 0;
    for (std::size_t i = 0; i < mesh().triangles().size(); ++i) {
      const Point& a = mesh().corner_m(i, 0);
      const double before = mesh().normals()[i].dot(from - a);
      const double after = mesh().normals()[i].dot(to - a);
      if ((before > 0) == (after > 0)) continue;
      const Point ab = mesh().corner_m(i, 1) - a;
      const Point ac = mesh().corner_m(i, 2) - a;
      const Point at = from + before / (before - after) * (to - from) - a;
      const Point normal = ab.cross(ac);
      const double u = normal.dot(at.cross(ac)) / normal.squaredNorm();
      const double v = normal.dot(ab.cross(at)) / normal.squaredNorm();
      if (std::min({u, v, 1 - u - v}) > -1e-6) ++count;
    }
    return count;
  }

  [[nodiscard]] bool touches(const Point& p) const { return object_.bvh().nearest(p, kOff_m).has_value(); }

  /// From the nearest edge of one triangle only.
  [[nodiscard]] double rim_distance_m(const Point& p) const {
    if (mesh().report().closed()) return std::numeric_limits<double>::infinity();
    double least_m = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < mesh().triangles().size(); ++i) {
      for (std::size_t side = 0; side < 3; ++side) {
        if (mesh().neighbours()[i][side] != TriangleMesh::kNone) continue;
        const Point& a = mesh().corner_m(i, side);
        const Point along = mesh().corner_m(i, (side + 1) % 3) - a;
        const double share = std::clamp(along.dot(p - a) / along.squaredNorm(), 0.0, 1.0);
        least_m = std::min(least_m, (a + share * along - p).norm());
      }
    }
    return least_m;
  }

  const FeltSurface& surface_;
  Eigen::Isometry3d back_;  // from the scene into the surface's frame
  GodObject object_;
  Proxy proxy_{};
  std::mt19937 random_;
  Point device_m_ = Point::Zero();
  Point free_m_ = Point::Zero();  // where the device was without a contact last
  int count_ = 0;
  int free_ = 0;
};

TEST(TwoSidedMesh, CapturesNothingInPressesAndSlidesOverEdges) {
  for (const FeltSurface& surface : surfaces()) {
    int slides_count = 0;
    int free_count = 0;
    for (const auto& motion : {Eigen::Isometry3d::Identity(), test::askew()}) {
      Slides slides(surface, motion);
      for (unsigned seed = 1; slides.count() < 500; ++seed) {
        SCOPED_TRACE(surface.name + ", seed " + std::to_string(seed));
        slides.run(seed);
        if (HasFailure()) return;
      }
      slides_count += slides.count();
      free_count += slides.free();
    }
    EXPECT_EQ(slides_count, 1000) << surface.name;
    EXPECT_GT(free_count, 1000) << surface.name << " was hardly ever left";
  }
}

TEST(TwoSidedMesh, FollowDoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  Follower follower(saddle(), {.two_sided = true});
  double sum_m = 0;
  const test::AllocationGuard guard;
  for (int i = 0; i < 2000; ++i)
    sum_m += follower.to({0.03 * std::cos(0.01 * i), 0.03 * std::sin(0.007 * i), -0.005 - 1e-6 * i}).penetration_m;
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_GT(sum_m, 0);
}

}  // namespace
}  // namespace forcebound::scene
