#include "tests/tools/lab/accuracy/along.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "forcebound/time/heap_operations.hpp"
#include "tests/tools/lab/accuracy/instruction_counter.hpp"
#include "tests/tools/lab/trials/percentile.hpp"

namespace forcebound::lab {
namespace {

using std::chrono::milliseconds;

double since_ns(time::Nanoseconds begin, const time::Clock& clock) {
  return static_cast<double>((clock.now() - begin).count());
}

/// Share of the steps.
struct Steps {
  std::vector<double> durations_ns{};
  std::vector<double> instructions{};
  double heap_operations = 0;

  [[nodiscard]] StepWork per_step() const {
    StepWork work;
    if (time::kCountsHeapOperations) {
      work.heap_operations = heap_operations / static_cast<double>(durations_ns.size());
    }
    if (!instructions.empty()) work.instructions = percentile(instructions, 0.5);
    return work;
  }
};

}  // namespace

std::string trouble_of(const scene::SceneFaults& faults, std::size_t steps) {
  const auto share = [&](std::uint64_t count) {
    return std::to_string(count) + " of " + std::to_string(steps) + " steps";
  };
  if (faults.quarantined > 0) return "gave a force that is not finite";
  if (faults.dynamic_models.not_converged > steps / 100)
    return "not converged on " + share(faults.dynamic_models.not_converged);
  if (faults.dynamic_models.contacts_left_out > 0)
    return "contacts left out on " + share(faults.dynamic_models.contacts_left_out);
  if (faults.dynamic_models.slipped_s > 0) return "too many steps for a motion: simulated time skipped";
  return {};
}

StepCost cost_of(const std::vector<double>& durations_ns) {
  return {.median_us = percentile(durations_ns, 0.5) * 1e-3,
          .p99_us = percentile(durations_ns, 0.99) * 1e-3,
          .max_us = *std::ranges::max_element(durations_ns) * 1e-3,
          .spread_us = (percentile(durations_ns, 0.75) - percentile(durations_ns, 0.25)) * 1e-3};
}

Along run_along(const std::shared_ptr<const scene::Scene>& scene, const std::vector<Vector>& positions_m,
                const time::Clock& clock) {
  Along run;
  scene::SceneState state(scene, static_cast<std::uint32_t>(positions_m.front().rows()));
  BodyWatch watch(state);
  const InstructionCounter instructions;
  Steps felt;
  Steps free;
  Steps idle;
  time::Nanoseconds now{0};
  for (const Vector& position_m : positions_m) {
    const std::uint64_t heap_before = time::heap_operations_of_this_thread();
    const auto instructions_before = instructions.count();
    const time::Nanoseconds begin = clock.now();
    scene::Answer answer = state.answer(position_m, now);
    const double duration_ns = since_ns(begin, clock);
    const auto instructions_after = instructions.count();
    const std::uint64_t heap_after = time::heap_operations_of_this_thread();
    Steps& steps = !watch.observe() ? idle : answer.force.isZero(0) ? free : felt;
    steps.durations_ns.push_back(duration_ns);
    steps.heap_operations += static_cast<double>(heap_after - heap_before);
    if (instructions_before && instructions_after) {
      steps.instructions.push_back(static_cast<double>(*instructions_after - *instructions_before));
    }
    now += milliseconds{1};
    if (!run.forces.empty()) {
      const Vector moved_m = position_m - positions_m[run.forces.size() - 1];
      run.work_J += 0.5 * (answer.force + run.forces.back()).dot(moved_m);
    }
    run.forces.push_back(std::move(answer.force));
    run.penetrations_m.push_back(answer.penetration_m);
  }
  const Steps& counted = !felt.durations_ns.empty() ? felt : !free.durations_ns.empty() ? free : idle;
  run.cost = cost_of(counted.durations_ns);
  run.per_step = counted.per_step();
  if (watch.any()) run.bodies = watch.record();
  run.trouble = trouble_of(state.faults(), positions_m.size());
  return run;
}

StepCost idle_noise(double about_us, int times, const time::Clock& clock) {
  volatile double sink = 1;
  const auto spin = [&](std::int64_t turns) {
    for (std::int64_t i = 0; i < turns; ++i) sink = sink * 1.0000001;
  };
  constexpr std::int64_t kTrial = 100000;
  const time::Nanoseconds begin = clock.now();
  spin(kTrial);
  const double ns_a_turn = std::max(1e-3, since_ns(begin, clock) / static_cast<double>(kTrial));
  const auto turns = static_cast<std::int64_t>(about_us * 1e3 / ns_a_turn);
  std::vector<double> durations_ns;
  for (int i = 0; i < times; ++i) {
    const time::Nanoseconds before = clock.now();
    spin(turns);
    durations_ns.push_back(since_ns(before, clock));
  }
  return cost_of(durations_ns);
}

StateError state_error(const Along& run, const Along& reference) {
  StateError error;
  const double size_N = rms(reference.forces);
  if (size_N > 0) error.force = rms_difference(run.forces, reference.forces) / size_N;
  std::vector<double> angles_deg;
  double in_contact = 0;
  double depth_m2 = 0;
  double force_N2 = 0;
  for (std::size_t i = 0; i < run.forces.size(); ++i) {
    const Vector& is = run.forces[i];
    const Vector& should = reference.forces[i];
    if (is.norm() > 0.01 * size_N && should.norm() > 0.01 * size_N) {
      // Of the half angle, whose sine does not round small angles away.
      const double half = std::min(1.0, 0.5 * (is.normalized() - should.normalized()).norm());
      angles_deg.push_back(2 * std::asin(half) * 180 / std::numbers::pi);
    }
    if (!(run.penetrations_m[i] > 0)) continue;
    ++in_contact;
    error.penetration_m += run.penetrations_m[i];
    depth_m2 += run.penetrations_m[i] * run.penetrations_m[i];
    force_N2 += is.squaredNorm();
  }
  if (!angles_deg.empty()) {
    error.direction_median_deg = percentile(angles_deg, 0.5);
    error.direction_p95_deg = percentile(angles_deg, 0.95);
  }
  if (in_contact > 0) error.penetration_m /= in_contact;
  if (depth_m2 > 0) error.displayed_stiffness_N_per_m = std::sqrt(force_N2 / depth_m2);
  error.work_J = run.work_J - reference.work_J;
  return error;
}

}  // namespace forcebound::lab
