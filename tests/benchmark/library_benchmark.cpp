// Cost of a law's tick through the C interface, beside the same tick in C++, in one run:
//
//     cmake --preset release && cmake --build --preset release --target library_benchmark
//     build/release/bin/library_benchmark --benchmark_repetitions=20 --benchmark_enable_random_interleaving=true

#include <benchmark/benchmark.h>
#include <forcebound.h>

#include <array>
#include <cstddef>
#include <cstdlib>
#include <vector>

#include "forcebound/baselines/running_law.hpp"
#include "forcebound/device/load_device.hpp"
#include "tests/support/random_ticks.hpp"

namespace forcebound::library {
namespace {

constexpr const char* kDevice = "firm-3dof";

std::vector<test::ReferenceTick> ticks() { return test::random_ticks({.degrees_of_freedom = 3, .motion_m = 3e-4}); }

void in_cpp(benchmark::State& state, const char* law) {
  const auto steps = ticks();
  baselines::RunningLaw running(device::load_device(kDevice).facts, law, {});
  std::size_t next = 0;
  for (auto _ : state) {
    control::Motion& motion = running.motion();
    motion.interval_s = running.begun() ? 1e-3 : 0;
    motion.position = Eigen::Map<const Eigen::Vector3d>(steps[next].position_m.data());
    const control::Vector request_N = Eigen::Map<const Eigen::Vector3d>(steps[next].request_N.data());
    benchmark::DoNotOptimize(running.tick(request_N));
    if (++next == steps.size()) next = 0;
  }
}

void in_c(benchmark::State& state, const char* name) {
  const auto steps = ticks();
  fb_facts* facts = nullptr;
  fb_law* law = nullptr;
  if (fb_facts_load(kDevice, &facts) != FB_OK || fb_law_create(name, facts, nullptr, &law) != FB_OK) {
    state.SkipWithError(fb_last_error());
    return;
  }
  fb_motion motion = FB_INIT(fb_motion);
  std::array<double, 3> force_N{};
  std::size_t next = 0;
  for (auto _ : state) {
    for (std::size_t i = 0; i < 3; ++i) motion.position[i] = steps[next].position_m[i];
    benchmark::DoNotOptimize(fb_law_tick(law, &motion, steps[next].request_N.data(), force_N.data(), 3));
    benchmark::DoNotOptimize(force_N);
    motion.interval_s = 1e-3;
    if (++next == steps.size()) next = 0;
  }
  fb_law_destroy(law);
  fb_facts_destroy(facts);
}

BENCHMARK_CAPTURE(in_cpp, fba_exact, "fba-exact");
BENCHMARK_CAPTURE(in_c, fba_exact, "fba-exact");
BENCHMARK_CAPTURE(in_cpp, fba_less, "fba-less");
BENCHMARK_CAPTURE(in_c, fba_less, "fba-less");

}  // namespace
}  // namespace forcebound::library
