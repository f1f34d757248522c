#include "forcebound/scene/plan.hpp"

#include <algorithm>

namespace forcebound::scene {

Plan::Plan(std::span<const SceneObject> objects, std::span<const SceneObject> fields) {
  for (const SceneObject& object : objects) add(object);
  for (const SceneObject& field : fields) add(field);
}

void Plan::add(const SceneObject& part) {
  PlanStep step{};
  step.shape = part.shape.get();
  step.shape_state = keep(part.shape ? part.shape->facts().state_bytes : 0);
  const auto here = [this] { return static_cast<std::uint32_t>(effects_.size()); };

  step.begin = here();
  step.near_state = keep(0);
  const bool field = part.shape == nullptr;
  add_effects(part, [field](const EffectFacts& facts) { return field || facts.reach_m > 0; });
  step.near_end = here();
  step.touching_state = keep(0);
  add_effects(part,
              [field](const EffectFacts& facts) { return !field && !(facts.reach_m > 0) && !facts.inputs.pressure; });
  step.touching_end = here();
  add_effects(part,
              [field](const EffectFacts& facts) { return !field && !(facts.reach_m > 0) && facts.inputs.pressure; });
  step.end = here();
  step.end_state = keep(0);
  for (const RequestedEffect& requested : part.effects) {
    const EffectFacts facts = requested.effect->facts();
    step.reach_m = std::max(step.reach_m, facts.reach_m);
    step.solid = step.solid || (facts.solid && !field);
  }
  steps_.push_back(step);
}

template <class Wanted>
void Plan::add_effects(const SceneObject& part, Wanted wanted) {
  for (const RequestedEffect& requested : part.effects) {
    const EffectFacts facts = requested.effect->facts();
    if (!wanted(facts)) continue;
    effects_.push_back({requested.effect.get(), keep(facts.state_bytes), facts.fades_without_server});
    inputs_ = inputs_.with(facts.inputs);
    fades_without_server_ = fades_without_server_ || facts.fades_without_server;
  }
}

std::uint32_t Plan::keep(std::size_t bytes) {
  constexpr std::size_t kAligned = alignof(double);
  const std::size_t begin = state_bytes_;
  state_bytes_ += (bytes + kAligned - 1) / kAligned * kAligned;
  return static_cast<std::uint32_t>(begin);
}

}  // namespace forcebound::scene
