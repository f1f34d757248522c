#pragma once

#include <cstdint>
#include <string>

#include "tests/tools/lab/soak/soak_tip.hpp"

namespace forcebound::lab {

/// Result of one seed.
struct SoakResult {
  std::string broken;  ///< empty: every invariant held on every tick
  std::string environment;
  bool passive = false;        ///< the law guaranteed P >= 0
  bool beyond_bounds = false;  ///< the device's truth lay outside its facts' bounds
  double least_P_J = 0;
  std::uint64_t digest = 0;  ///< of every force and position: equal runs have equal ones
  double virtual_s = 0;
  std::uint64_t ticks = 0;
  std::uint64_t recomputed = 0;  ///< ticks whose ledger could be recomputed
  std::uint64_t late_ticks = 0;
  std::uint64_t released = 0;   ///< ticks so late that the device had let go
  std::uint64_t withdrawn = 0;  ///< forces commanded too late
  std::uint64_t reconnects = 0;
  std::uint64_t lost = 0;  ///< datagrams, either way
};

struct SoakCase;

/// A law drawn from all, or from those that take a device of six axes.
[[nodiscard]] std::string law_of(std::uint64_t seed, SoakTip tip = SoakTip::point);

/// Draws a run from the seed, runs it with this law, and checks on every tick what must hold for all laws and what this
/// law guarantees.
[[nodiscard]] SoakResult soak(std::uint64_t seed, const std::string& law, SoakTip tip = SoakTip::point);

/// The same of a case that is drawn already.
[[nodiscard]] SoakResult soak(const SoakCase& drawn);

}  // namespace forcebound::lab
