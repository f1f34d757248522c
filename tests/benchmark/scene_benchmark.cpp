// Cost of one motion at the server: SceneState::answer, beside plain Eigen expressions that do the same arithmetic.
// Build it optimised:
//
//     cmake --preset release && cmake --build --preset release --target scene_benchmark
//     build/release/bin/scene_benchmark --benchmark_repetitions=9 --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <string>

#include "forcebound/scene/scene_state.hpp"
#include "forcebound/server/environment/scene_library.hpp"

namespace forcebound::server {
namespace {

constexpr std::size_t kPlaces = 1024;

/// A random path within 30 mm of the origin.
std::array<control::Vector, kPlaces> places() {
  std::array<control::Vector, kPlaces> all;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    const double t = 0.01 * static_cast<double>(i);
    all[i] = 0.03 * scene::Point(std::sin(t), std::sin(1.7 * t + 1), std::sin(2.3 * t + 2));
  }
  return all;
}

void answers(benchmark::State& state, const std::shared_ptr<const scene::Scene>& scene) {
  const auto path = places();
  scene::SceneState client(scene, 3);
  time::Nanoseconds now{0};
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(client.answer(path[next++ % kPlaces], now));
    now += std::chrono::milliseconds(1);
  }
}

/// Gravity, viscosity and a spring to a point, as fields.
void three_fields(benchmark::State& state) {
  answers(state, parse_scene(R"(
[scene]
name = "three fields"
description = ""
degrees_of_freedom = 3
[[field]]
name = "weight"
effects = ["gravity"]
gravity = { mass_kg = 0.1, direction = [0, 0, -1] }
[[field]]
name = "honey"
effects = ["viscosity"]
viscosity = { damping_N_s_per_m = 4 }
[[field]]
name = "anchor"
effects = ["spring_to_point"]
spring_to_point = { center_m = [0, 0, 0], stiffness_N_per_m = 200, damping_N_s_per_m = 1 }
)",
                             "three_fields.toml"));
}

/// The same forces, in plain Eigen.
void three_fields_in_eigen(benchmark::State& state) {
  const auto path = places();
  scene::Point last_m = path[0];
  scene::Point weight_N(0, 0, -0.981);
  benchmark::DoNotOptimize(weight_N);
  std::size_t next = 0;
  for (auto _ : state) {
    const scene::Point position_m = path[next++ % kPlaces];
    const scene::Point velocity_m_per_s = (position_m - last_m) / 1e-3;
    last_m = position_m;
    const scene::Point force_N = weight_N - 4 * velocity_m_per_s - (200 * position_m + velocity_m_per_s);
    benchmark::DoNotOptimize(force_N);
  }
}

/// The scene's sphere, in plain Eigen.
void sphere_in_eigen(benchmark::State& state) {
  const auto path = places();
  std::size_t next = 0;
  for (auto _ : state) {
    const scene::Point out_m = path[next++ % kPlaces];
    const double distance_m = out_m.stableNorm();
    scene::Point force_N = scene::Point::Zero();
    if (distance_m < 0.02) force_N = 10000 * (0.02 - distance_m) / distance_m * out_m;
    benchmark::DoNotOptimize(force_N);
  }
}

void shipped(benchmark::State& state, const char* name) { answers(state, load_scene(name)); }

BENCHMARK(three_fields);
BENCHMARK(three_fields_in_eigen);
BENCHMARK(sphere_in_eigen);
BENCHMARK_CAPTURE(shipped, free, "free");
BENCHMARK_CAPTURE(shipped, plane, "plane");
BENCHMARK_CAPTURE(shipped, sphere, "sphere");
BENCHMARK_CAPTURE(shipped, box, "box");
BENCHMARK_CAPTURE(shipped, capsule, "capsule");
BENCHMARK_CAPTURE(shipped, cylinder, "cylinder");
BENCHMARK_CAPTURE(shipped, torus, "torus");
BENCHMARK_CAPTURE(shipped, height_field, "height_field");
BENCHMARK_CAPTURE(shipped, viscosity, "viscosity");
BENCHMARK_CAPTURE(shipped, constant_force, "constant_force");
BENCHMARK_CAPTURE(shipped, gravity, "gravity");
BENCHMARK_CAPTURE(shipped, flow, "flow");
BENCHMARK_CAPTURE(shipped, attractor, "attractor");
BENCHMARK_CAPTURE(shipped, spring_to_point, "spring_to_point");
BENCHMARK_CAPTURE(shipped, spring_to_line, "spring_to_line");
BENCHMARK_CAPTURE(shipped, spring_to_plane, "spring_to_plane");
BENCHMARK_CAPTURE(shipped, workspace_limit, "workspace_limit");
BENCHMARK_CAPTURE(shipped, drive, "drive");
BENCHMARK_CAPTURE(shipped, guidance, "guidance");
BENCHMARK_CAPTURE(shipped, microsurgery, "microsurgery");

}  // namespace
}  // namespace forcebound::server
