#include "forcebound/scene/plan_run.hpp"

#include <algorithm>

namespace forcebound::scene {

void PlanRun::act(const PlanStep& step, Probe& probe, Reaction& reaction) const noexcept {
  if (step.shape != nullptr && !(probe.penetration_m > -step.reach_m)) {
    forget(step.near_state, step.end_state);
    return;
  }
  run(step.begin, step.near_end, probe, reaction);
  if (!(probe.penetration_m > 0)) {
    forget(step.touching_state, step.end_state);
    return;
  }
  run(step.near_end, step.touching_end, probe, reaction);
  probe.pressure_N = std::max(0.0, reaction.force_N.dot(probe.normal));
  run(step.touching_end, step.end, probe, reaction);
}

void PlanRun::run(std::uint32_t begin, std::uint32_t end, const Probe& probe, Reaction& reaction) const noexcept {
  for (std::uint32_t i = begin; i < end; ++i) {
    const PlannedEffect& planned = plan_.effects()[i];
    const Point others_N = reaction.force_N;
    planned.effect->act(probe, states_ + planned.state, reaction);
    if (planned.fades_without_server) reaction.fading_N += reaction.force_N - others_N;
  }
}

void PlanRun::forget(std::uint32_t begin, std::uint32_t end) const noexcept {
  std::fill(states_ + begin, states_ + end, std::byte{0});
}

}  // namespace forcebound::scene
