#pragma once

#include <vector>

#include "forcebound/server/effects/effect.hpp"

namespace forcebound::test {

/// One effect with the state of one session.
class Felt {
 public:
  explicit Felt(const server::Effect& effect)
      : effect_(effect), state_(effect.facts().state_bytes / sizeof(double) + 1) {}

  server::Reaction operator()(const server::Probe& probe) {
    server::Reaction reaction;
    effect_.act(probe, reinterpret_cast<std::byte*>(state_.data()), reaction);
    return reaction;
  }

 private:
  const server::Effect& effect_;
  std::vector<double> state_;
};

/// The force of one effect with a state that begins anew.
inline server::Point force_N(const server::Effect& effect, const server::Probe& probe) {
  return Felt(effect)(probe).force_N;
}

inline server::Probe probe_at(const server::Point& position_m) { return {.position_m = position_m}; }

}  // namespace forcebound::test
