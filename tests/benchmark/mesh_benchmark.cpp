// What one motion on a triangle mesh costs: a step of the god object that slides over a ball of 70 thousand triangles,
// with Embree's ray and nearest point and FCL's distance on the same mesh beside it. Embree computes in single
// precision, and its nearest point asks our function for each triangle; FCL is asked for the distance of a ball of no
// size. Build it optimised:
//
//     cmake --preset release && cmake --build --preset release --target mesh_benchmark
//     build/release/bin/mesh_benchmark --benchmark_repetitions=9 --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <vector>

#include "forcebound/scene/geometry/distance_field.hpp"
#include "tests/support/embree_scene.hpp"
#include "tests/support/fcl_scene.hpp"
#include "tests/support/follower.hpp"
#include "tests/support/shape_client.hpp"

namespace forcebound {
namespace {

using scene::Point;

constexpr std::uint32_t kRows = 133;  // 4 * 133 * 132 = 70224 triangles
constexpr double kRadius_m = 0.05;

/// A hand that draws circles and eights on the ball at 0.2 m/s, some depth below its surface, read at 1 kHz.
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

scene::Segment through_the_surface(const Point& goal) { return {1.1 * goal, -0.1 * goal}; }

void our_segment(benchmark::State& state) {
  const scene::Bvh bvh(std::make_shared<const scene::TriangleMesh>(ball().mesh()));
  ask_along_the_way(state,
                    [&](const Point& goal) { benchmark::DoNotOptimize(bvh.first_hit(through_the_surface(goal))); });
}

void embree_segment(benchmark::State& state) {
  const auto mesh = ball().mesh();
  const test::EmbreeScene embree(mesh);
  ask_along_the_way(state,
                    [&](const Point& goal) { benchmark::DoNotOptimize(embree.first_hit(through_the_surface(goal))); });
}

/// The ball with so many triangles.
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

void sizes(benchmark::internal::Benchmark* nearest_point) {
  nearest_point->ArgName("triangles");
  for (const int rows : {17, 34, 67, 133}) nearest_point->Arg(4 * rows * (rows - 1));
}

BENCHMARK(god_object_slides)->ArgName("depth_um")->Arg(10)->Arg(1000)->Arg(10000);
BENCHMARK(god_object_moves_freely);
BENCHMARK(distance_field_slides);
BENCHMARK(our_segment);
BENCHMARK(embree_segment);
BENCHMARK(our_nearest_point)->Apply(sizes);
BENCHMARK(embree_nearest_point)->Apply(sizes);
BENCHMARK(fcl_nearest_point)->Apply(sizes);

}  // namespace
}  // namespace forcebound
