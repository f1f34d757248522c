#include <benchmark/benchmark.h>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"

namespace forcebound::client {
namespace {

/// One tick of 1 ms: read and apply, with the hand moving.
void tick(benchmark::State& state, const char* name, double force_N) {
  const device::DeviceDescription description = device::load_device(name);
  const int dof = description.facts.degrees_of_freedom();
  device::SimulatedDevice device(description, device::make_operator("wave", dof));
  time::Nanoseconds now{0};
  control::Vector force = control::Vector::Constant(dof, force_N);
  for (auto _ : state) {
    benchmark::DoNotOptimize(device.read(now));
    device.apply(now, force);
    force = -force;
    now += std::chrono::milliseconds(1);
  }
}

BENCHMARK_CAPTURE(tick, wall_1dof, "wall-1dof", 0.5);
BENCHMARK_CAPTURE(tick, cartesian_2dof, "cartesian-2dof", 0.5);
BENCHMARK_CAPTURE(tick, cartesian_3dof, "cartesian-3dof", 0.5);
BENCHMARK_CAPTURE(tick, omni, "omni", 0.5);

/// An active force, so that the audit reaches a new minimum on many ticks and must search for it.
void pumped_tick(benchmark::State& state, const char* name) {
  const device::DeviceDescription description = device::load_device(name);
  const int dof = description.facts.degrees_of_freedom();
  device::SimulatedDevice device(description, device::make_operator("wave", dof));
  time::Nanoseconds now{0};
  for (auto _ : state) {
    device::Reading reading = device.read(now);
    device.apply(now, 3 * device.truth().joint_velocity);
    benchmark::DoNotOptimize(reading);
    now += std::chrono::milliseconds(1);
  }
}

BENCHMARK_CAPTURE(pumped_tick, cartesian_3dof, "cartesian-3dof");

}  // namespace
}  // namespace forcebound::client
