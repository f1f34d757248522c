// What a tick spends on control: one step of PassivityController, from motion and request to the force, with a full
// damping matrix. Build it optimised:
//
//     cmake --preset release && cmake --build --preset release --target control_benchmark
//     build/release/bin/control_benchmark

#include <benchmark/benchmark.h>

#include <cstddef>
#include <vector>

#include "forcebound/control/law_registry.hpp"
#include "forcebound/control/passivity_controller.hpp"
#include "tests/support/law_loop.hpp"
#include "tests/support/random_ticks.hpp"

namespace forcebound::control {
namespace {

struct Step {
  Vector position;
  Vector request_N;
};

std::vector<Step> steps_of(const std::vector<test::ReferenceTick>& ticks) {
  std::vector<Step> steps;
  steps.reserve(ticks.size());
  for (const auto& tick : ticks) steps.push_back({test::to_vector(tick.position_m), test::to_vector(tick.request_N)});
  return steps;
}

void law_step(benchmark::State& state, const char* law) {
  const int degrees_of_freedom = static_cast<int>(state.range(0));
  const auto ticks = test::random_ticks({.degrees_of_freedom = degrees_of_freedom, .motion_m = 3e-4});
  const std::vector<Step> steps = steps_of(ticks);
  test::LawLoop loop(law, test::to_matrix(ticks.front().damping_N_s_per_m), {.force_N_max = 15});
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(loop.tick(steps[next].position, steps[next].request_N));
    if (++next == steps.size()) next = 0;
  }
}

void arm_damping(benchmark::State& state) {
  const int degrees_of_freedom = static_cast<int>(state.range(0));
  const auto ticks = test::random_ticks({.degrees_of_freedom = degrees_of_freedom, .ticks = 1});
  const Matrix jacobian = 0.01 * test::to_matrix(ticks.front().damping_N_s_per_m);
  const Matrix joints = 1e-3 * Matrix::Identity(degrees_of_freedom, degrees_of_freedom);
  for (auto _ : state) benchmark::DoNotOptimize(Damping::from_joints(jacobian, joints));
}

BENCHMARK_CAPTURE(law_step, none, "none")->Arg(1)->Arg(3)->Arg(6);
BENCHMARK_CAPTURE(law_step, fba_less, "fba-less")->Arg(1)->Arg(3)->Arg(6);
BENCHMARK_CAPTURE(law_step, fba_more, "fba-more")->Arg(1)->Arg(3)->Arg(6);
BENCHMARK(arm_damping)->Arg(3)->Arg(6);

}  // namespace
}  // namespace forcebound::control
