#pragma once

#include <cstdint>
#include <functional>

#include "forcebound/control/vector.hpp"

namespace forcebound::test {

/// What an adversary took from a device, summed from what was applied and how the device moved, in long double.
struct Extraction {
  long double balance_J = 0;   ///< sum of d'B d - f'd
  long double least_J = 0;     ///< its minimum so far
  long double turnover_J = 0;  ///< sum of |d'B d| + |f'd|: what rounding is relative to
};

/// `dampings(tick)` holds from that tick on; `law` is called with position, request and damping and returns the force
/// that the device was given.
struct AdversaryRun {
  std::uint64_t seed = 1;
  int degrees_of_freedom = 1;
  int ticks = 3000;
  double period_s = 1e-3;
  std::function<control::Matrix(int tick)> dampings;
  std::function<control::Vector(const control::Vector& position, const control::Vector& request_N,
                                const control::Matrix& damping)>
      law;
};

/// Plays hand and environment against a law: asks for any force and moves so as to take the most energy out of it.
Extraction play(const AdversaryRun& run);

}  // namespace forcebound::test
