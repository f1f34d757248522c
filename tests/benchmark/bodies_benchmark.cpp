// A stack of boxes for half a second, by MuJoCo's own step and by ours of the same model with a probe beside it: the
// second may take 10 % longer than the first. Build it optimised:
//
//     cmake --preset release && cmake --build --preset release --target bodies_benchmark
//     build/release/bin/bodies_benchmark --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true

#include <benchmark/benchmark.h>
#include <mujoco/mujoco.h>

#include "forcebound/server/dynamics/bodies/body_dynamic_model.hpp"
#include "forcebound/server/dynamics/bodies/body_world.hpp"

namespace forcebound::server {
namespace {

constexpr int kSteps = 500;

BodyDynamicModel stack(benchmark::State& timing) {
  const auto boxes_high = static_cast<int>(timing.range(0));
  BodiesDescription boxes;
  boxes.bodies.push_back({.name = "floor", .size_m = {2, 2, 0.1}, .position_m = {0, 0, -0.05}});
  for (int i = 0; i < boxes_high; ++i) {
    boxes.bodies.push_back({.name = "box " + std::to_string(i),
                            .size_m = {0.1, 0.1, 0.05},
                            .mass_kg = 0.5,
                            .position_m = {0, 0, 0.025 + 0.05 * i}});
  }
  return {boxes, "stack"};
}

const BodyWorld& world_of(const scene::DynamicModelState& state) { return dynamic_cast<const BodyWorld&>(state); }

void report(benchmark::State& timing, const mjData& data) {
  timing.counters["contacts"] = data.ncon;
  timing.counters["top_m"] = data.xpos[3 * (timing.range(0) + 1) + 2];
}

void mujocos_step(benchmark::State& timing) {
  const BodyDynamicModel dynamic_model = stack(timing);
  const auto start = dynamic_model.make_state(1);
  const mjModel* model = &world_of(*start).model();
  mjData* data = mj_copyData(nullptr, model, &world_of(*start).data());
  // The parked probe's weight is borne, as in ours.
  const int probe = mj_name2id(model, mjOBJ_BODY, "probe 0");
  mju_scl3(data->xfrc_applied + 6 * probe, model->opt.gravity, -model->body_mass[probe]);
  for (auto _ : timing) mj_step(model, data);
  report(timing, *data);
  mj_deleteData(data);
}

void our_step(benchmark::State& timing) {
  const BodyDynamicModel dynamic_model = stack(timing);
  const auto state = dynamic_model.make_state(1);
  for (auto _ : timing) state->advance(1e-3);
  report(timing, world_of(*state).data());
}

void our_motion_with_a_hand(benchmark::State& timing) {
  const BodyDynamicModel dynamic_model = stack(timing);
  const auto state = dynamic_model.make_state(1);
  const int seat = state->join();
  for (auto _ : timing) {
    state->move(seat, {0.5, 0, 0.5}, scene::Point::Zero());
    state->advance(1e-3);
    benchmark::DoNotOptimize(state->touch(seat));
  }
  report(timing, world_of(*state).data());
}

void heights(benchmark::internal::Benchmark* stack) {
  stack->ArgName("boxes")->Arg(5)->Arg(10)->Arg(20)->Arg(40)->Iterations(kSteps);
}

BENCHMARK(mujocos_step)->Apply(heights);
BENCHMARK(our_step)->Apply(heights);
BENCHMARK(our_motion_with_a_hand)->ArgName("boxes")->Arg(20)->Iterations(kSteps);

}  // namespace
}  // namespace forcebound::server
