// Cost of control in a tick: one step of ForceBounder, from motion and request to the force, with a full damping
// matrix. Build it optimised:
//
//     cmake --preset release && cmake --build --preset release --target control_benchmark
//     build/release/bin/control_benchmark

#include <benchmark/benchmark.h>

#include <cstddef>
#include <random>
#include <vector>

#include "forcebound/control/exact_law.hpp"
#include "forcebound/control/force_bounder.hpp"
#include "forcebound/control/law_registry.hpp"
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

/// fba-exact in its most expensive case: creeping from count to count, with friction, latency and a request that
/// changes.
void exact_step_with_full_knots(benchmark::State& state) {
  const auto degrees_of_freedom = static_cast<Eigen::Index>(state.range(0));
  DeviceFacts facts;
  facts.damping = 30 * Matrix::Identity(degrees_of_freedom, degrees_of_freedom);
  facts.friction = Vector::Constant(degrees_of_freedom, 0.5);
  facts.encoder_step = Vector::Constant(degrees_of_freedom, 55e-6);
  facts.force_N_max = 3;
  facts.latency_s = 100e-6;
  ExactLaw law(facts);
  Motion motion;
  motion.interval_s = 1e-3;
  motion.latency_s = motion.latency_s_max = facts.latency_s;
  motion.position = motion.joint = Vector::Constant(degrees_of_freedom, 0.01);
  motion.jacobian = Matrix::Identity(degrees_of_freedom, degrees_of_freedom);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> force_N(-0.25, 0.25);
  std::vector<Vector> requests(1000);
  for (Vector& request : requests) {
    request = Vector::NullaryExpr(degrees_of_freedom, [&](Eigen::Index) { return force_N(random); });
  }
  std::size_t next = 0;
  for (auto _ : state) {
    if (next % 30 == 0) motion.joint.array() += random() % 2 == 0 ? 55e-6 : -55e-6;
    law.credit(motion);
    Vector force = law.bound(requests[next]);
    law.commit(force);
    benchmark::DoNotOptimize(force);
    if (++next == requests.size()) next = 0;
  }
}

void arm_damping(benchmark::State& state) {
  const int degrees_of_freedom = static_cast<int>(state.range(0));
  const auto ticks = test::random_ticks({.degrees_of_freedom = degrees_of_freedom, .ticks = 1});
  const Matrix jacobian = 0.01 * test::to_matrix(ticks.front().damping_N_s_per_m);
  const Matrix joints = 1e-3 * Matrix::Identity(degrees_of_freedom, degrees_of_freedom);
  for (auto _ : state) benchmark::DoNotOptimize(Damping::from_joints(jacobian, joints));
}

BENCHMARK_CAPTURE(law_step, none, "none")->DenseRange(1, 6);
BENCHMARK_CAPTURE(law_step, fba_less, "fba-less")->DenseRange(1, 6);
BENCHMARK_CAPTURE(law_step, fba_more, "fba-more")->DenseRange(1, 6);
BENCHMARK_CAPTURE(law_step, fba_exact, "fba-exact")->DenseRange(1, 6);
BENCHMARK(exact_step_with_full_knots)->Arg(1)->Arg(3)->Arg(6);
BENCHMARK(arm_damping)->Arg(3)->Arg(6);

}  // namespace
}  // namespace forcebound::control
