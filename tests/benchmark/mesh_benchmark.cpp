// Cost of one motion on a triangle mesh: a step of the god object that slides over a ball of 70 thousand triangles,
// with Embree's ray and nearest point and FCL's distance on the same mesh for comparison. Embree computes in single
// precision, and its nearest point calls our function for each triangle; FCL computes the distance of a ball of radius
// zero. The paths include hard cases: saddles, bumps and a concave corner, with the time of the slowest steps, the
// largest jump of the force of a spring of 1000 N/m, and how often a triangle about the god object would have let it
// nearer, checked triangle by triangle. Build it optimised:
//
//     cmake --preset release && cmake --build --preset release --target mesh_benchmark
//     build/release/bin/mesh_benchmark --benchmark_repetitions=9 --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <vector>

#include "forcebound/scene/geometry/distance_field.hpp"
#include "forcebound/server/environment/mesh_file.hpp"
#include "tests/support/embree_scene.hpp"
#include "tests/support/fcl_scene.hpp"
#include "tests/support/follower.hpp"
#include "tests/support/shape_client.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound {
namespace {

using scene::Point;

constexpr std::uint32_t kRows = 133;  // 4 * 133 * 132 = 70224 triangles
constexpr double kRadius_m = 0.05;

/// A hand that moves in circles and eights on the ball at 0.2 m/s, some depth below its surface, read at 1 kHz.
std::vector<Point> sliding_m(double depth_m) {
  std::vector<Point> goals;
  for (int i = 0; i < 20000; ++i) {
    const double turn = 0.2e-3 / kRadius_m * i;
    const double tilt = 0.5 * std::sin(0.37 * turn);
    goals.emplace_back((kRadius_m - depth_m) *
                       Point(std::cos(tilt) * std::cos(turn), std::cos(tilt) * std::sin(turn), std::sin(tilt)));
  }
  return goals;
}

const test::Soup& ball() {
  static const test::Soup kBall = test::ball(kRadius_m, kRows).moved(test::askew());
  return kBall;
}

/// Depth in micrometres.
void god_object_slides(benchmark::State& state) {
  const std::vector<Point> goals = sliding_m(1e-6 * static_cast<double>(state.range(0)));
  test::Follower follower(ball());
  (void)follower.to(2 * goals.front());
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(follower.to(goals[next]));
    if (++next == goals.size()) next = 0;
  }
  state.counters["triangles"] = static_cast<double>(follower.object().bvh().mesh().triangles().size());
  state.counters["memory_MB"] = 1e-6 * static_cast<double>(follower.object().memory_bytes());
}

void god_object_moves_freely(benchmark::State& state) {
  const std::vector<Point> goals = sliding_m(-1e-3);
  test::Follower follower(ball());
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(follower.to(goals[next]));
    if (++next == goals.size()) next = 0;
  }
}

/// A hand that goes over a mesh at 1 kHz.
struct Course {
  std::shared_ptr<const scene::TriangleMesh> mesh;
  Point start = Point::Zero();
  std::vector<Point> goals;
};

constexpr int kMotions = 20000;

std::shared_ptr<const scene::TriangleMesh> shared(scene::TriangleMesh mesh) {
  return std::make_shared<const scene::TriangleMesh>(std::move(mesh));
}

/// Around an object, at a share of half its bounding box.
std::vector<Point> round_m(const scene::TriangleMesh& mesh, double share) {
  std::vector<Point> goals;
  for (int i = 0; i < kMotions; ++i) {
    const double turn = 4e-3 * i;
    const double tilt = 0.9 * std::sin(0.37 * turn);
    const Point out(std::cos(tilt) * std::cos(turn), std::cos(tilt) * std::sin(turn), std::sin(tilt));
    goals.emplace_back(mesh.origin_m() + share * mesh.box_m().max().cwiseProduct(out));
  }
  return goals;
}

/// In eights over a plane, `middle_m` in the frame that `askew` turns, at 0.1 m/s.
std::vector<Point> eights_m(double half_m, const Point& middle_m, double up_m) {
  std::vector<Point> goals;
  for (int i = 0; i < kMotions; ++i) {
    const double turn = 0.1e-3 / half_m * i;
    goals.emplace_back(test::askew() * (middle_m + Point(half_m * std::sin(turn), half_m * std::sin(0.618 * turn + 1),
                                                         up_m * std::sin(0.31 * turn))));
  }
  return goals;
}

Course spot() {
  const auto path = recorded_data("meshes/spot.obj");
  if (!path) return {};
  const auto mesh = shared(server::load_mesh(path->string(), {.scale = kRadius_m}));
  return {mesh, {1, 0, 0}, round_m(*mesh, 0.55)};
}

Course rough_ball() {
  const auto mesh = shared(test::rough(test::ball(kRadius_m, 30), 1.5e-3, 1).moved(test::askew()).mesh());
  return {mesh, {1, 0, 0}, round_m(*mesh, 0.85)};
}

Course saddles() {
  test::Soup soup = test::square(kRadius_m, 40);
  for (Point& v : soup.vertices) v.z() = 4e-3 * std::sin(240 * v.x()) * std::sin(240 * v.y());
  return {shared(soup.moved(test::askew()).mesh()), test::askew() * Point(0, 0, 0.1),
          eights_m(0.045, {0, 0, -6e-3}, 3e-3)};
}

/// Three inner sides of a box that meet in a corner, welded before roughening.
Course rough_corner() {
  test::Soup corner;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Eigen::Isometry3d side = Eigen::Isometry3d::Identity();
    side.linear() << Point::Unit((axis + 2) % 3), Point::Unit((axis + 1) % 3), -Point::Unit(axis);
    side.translation() = kRadius_m * Point::Unit(axis);
    corner.add(test::square(kRadius_m, 12).moved(side));
  }
  const scene::TriangleMesh smooth = corner.mesh();
  const test::Soup soup = test::rough({smooth.vertices_m(), smooth.triangles()}, 8e-4, 3);
  return {shared(soup.moved(test::askew()).mesh()), Point::Zero(), eights_m(0.02, Point::Constant(kRadius_m), 0.01)};
}

/// How much nearer to the goal the triangles about the god object would let it.
double nearer_m(const test::Follower& follower, const Point& goal) {
  const scene::Bvh& bvh = follower.object().bvh();
  const Point at = follower.at_m() - bvh.mesh().origin_m();
  const Point to = goal - bvh.mesh().origin_m();
  double best_m = 0;
  const double about_m = 1e-9 * bvh.mesh().size_m();
  bvh.for_each_about({at.array() - about_m, at.array() + about_m}, [&](std::uint32_t place) {
    if ((bvh.nearest_on(bvh.order()[place], at).point_m - at).norm() > about_m) return;
    best_m = std::max(best_m, (at - to).norm() - (bvh.nearest_on(bvh.order()[place], to).point_m - to).norm());
  });
  return best_m;
}

void god_object_on_a_course(benchmark::State& state, Course (*course)()) {
  const auto [mesh, start, goals] = course();
  if (!mesh) {
    state.SkipWithError("no meshes/spot.obj in FORCEBOUND_DATA");
    return;
  }
  test::Follower follower(*mesh);
  (void)follower.to(start);
  Point before = Point::Zero();
  double jump_N = 0;
  double contacts = 0;
  double best = 0;
  for (const Point& goal : goals) {
    const scene::SurfacePoint found = follower.to(goal);
    const Point force = 1000 * test::spring_force(found);
    jump_N = std::max(jump_N, (force - before).norm());
    before = force;
    if (!(found.penetration_m > 0)) continue;
    ++contacts;
    best += nearer_m(follower, goal) < 1e-9 * mesh->size_m() ? 1 : 0;
  }
  std::vector<double> steps_ns;
  for (std::size_t next = 0; auto _ : state) {
    const auto begin = std::chrono::steady_clock::now();
    benchmark::DoNotOptimize(follower.to(goals[next]));
    steps_ns.push_back(std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count());
    if (++next == goals.size()) next = 0;
  }
  std::ranges::sort(steps_ns);
  const auto part = [&](double share) {
    return steps_ns[static_cast<std::size_t>(share * static_cast<double>(steps_ns.size() - 1))];
  };
  state.counters["p50_ns"] = part(0.5);
  state.counters["p99_ns"] = part(0.99);
  state.counters["max_ns"] = part(1);
  state.counters["jump_N"] = jump_N;
  state.counters["at_best_percent"] = 100 * best / contacts;
}

/// The ball as a signed distance field, with 2 mm between its nodes.
void distance_field_slides(benchmark::State& state) {
  const std::vector<Point> goals = sliding_m(1e-3);
  const auto mesh = std::make_shared<const scene::TriangleMesh>(ball().mesh());
  test::ShapeClient client(scene::make_distance_field(mesh, {.spacing_m = 2e-3}));
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(client.at(goals[next]));
    if (++next == goals.size()) next = 0;
  }
  state.counters["memory_MB"] = 1e-6 * static_cast<double>(client.shape().facts().memory_bytes);
}

template <class Ask>
void ask_along_the_way(benchmark::State& state, Ask ask) {
  const std::vector<Point> goals = sliding_m(1e-3);
  std::size_t next = 0;
  for (auto _ : state) {
    ask(goals[next]);
    if (++next == goals.size()) next = 0;
  }
}

/// The ball with that number of triangles.
scene::TriangleMesh ball_of(std::int64_t triangles) {
  std::uint32_t rows = 2;
  while (4 * rows * (rows - 1) < triangles) ++rows;
  return test::ball(kRadius_m, rows).moved(test::askew()).mesh();
}

void our_nearest_point(benchmark::State& state) {
  const scene::Bvh bvh(std::make_shared<const scene::TriangleMesh>(ball_of(state.range(0))));
  ask_along_the_way(state, [&](const Point& goal) { benchmark::DoNotOptimize(bvh.nearest(goal)); });
}

void embree_nearest_point(benchmark::State& state) {
  const auto mesh = ball_of(state.range(0));
  const test::EmbreeScene embree(mesh);
  ask_along_the_way(state, [&](const Point& goal) { benchmark::DoNotOptimize(embree.nearest_distance_m(goal)); });
}

void fcl_nearest_point(benchmark::State& state) {
  const test::FclScene fcl(ball_of(state.range(0)));
  ask_along_the_way(state, [&](const Point& goal) { benchmark::DoNotOptimize(fcl.nearest_distance_m(goal)); });
}

void our_tree_is_built(benchmark::State& state) {
  const auto mesh = shared(ball_of(state.range(0)));
  for (auto _ : state) {
    const scene::Bvh bvh(mesh);
    benchmark::DoNotOptimize(bvh.order().data());
  }
}

void embree_tree_is_built(benchmark::State& state) {
  const auto mesh = ball_of(state.range(0));
  for (auto _ : state) {
    const test::EmbreeScene embree(mesh);
    benchmark::DoNotOptimize(&embree);
  }
}

void fcl_tree_is_built(benchmark::State& state) {
  const auto mesh = ball_of(state.range(0));
  for (auto _ : state) {
    const test::FclScene fcl(mesh);
    benchmark::DoNotOptimize(&fcl);
  }
}

void sizes(benchmark::internal::Benchmark* nearest_point) {
  nearest_point->ArgName("triangles");
  for (const int rows : {17, 34, 67, 133}) nearest_point->Arg(4 * rows * (rows - 1));
}

BENCHMARK(god_object_slides)->ArgName("depth_um")->Arg(10)->Arg(1000)->Arg(10000);
BENCHMARK(god_object_moves_freely);
BENCHMARK_CAPTURE(god_object_on_a_course, spot, spot)->Iterations(kMotions);
BENCHMARK_CAPTURE(god_object_on_a_course, rough_ball, rough_ball)->Iterations(kMotions);
BENCHMARK_CAPTURE(god_object_on_a_course, saddles, saddles)->Iterations(kMotions);
BENCHMARK_CAPTURE(god_object_on_a_course, rough_corner, rough_corner)->Iterations(kMotions);
BENCHMARK(distance_field_slides);
BENCHMARK(our_nearest_point)->Apply(sizes);
BENCHMARK(embree_nearest_point)->Apply(sizes);
BENCHMARK(fcl_nearest_point)->Apply(sizes);
BENCHMARK(our_tree_is_built)->Apply(sizes)->Unit(benchmark::kMillisecond);
BENCHMARK(embree_tree_is_built)->Apply(sizes)->Unit(benchmark::kMillisecond);
BENCHMARK(fcl_tree_is_built)->Apply(sizes)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace forcebound
