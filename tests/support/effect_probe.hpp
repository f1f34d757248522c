#pragma once

#include <vector>

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::test {

/// Applies one effect, with the state of one session, to motions of a probe.
class EffectProbe {
 public:
  explicit EffectProbe(const scene::Effect& effect)
      : effect_(effect), state_(effect.facts().state_bytes / sizeof(double) + 1) {}

  scene::Reaction operator()(const scene::Probe& probe) {
    scene::Reaction reaction;
    effect_.act(probe, reinterpret_cast<std::byte*>(state_.data()), reaction);
    return reaction;
  }

 private:
  const scene::Effect& effect_;
  std::vector<double> state_;
};

/// The force of one effect with a state that begins anew.
inline scene::Point force_N(const scene::Effect& effect, const scene::Probe& probe) {
  return EffectProbe(effect)(probe).force_N;
}

inline scene::Probe probe_at(const scene::Point& position_m) { return {.position_m = position_m}; }

}  // namespace forcebound::test
