#pragma once

#include <cstdint>
#include <functional>

#include "forcebound/control/vector.hpp"

namespace forcebound::test {

/// The energy that an adversary took from a device, summed from applied forces and motion, in long double.
struct Extraction {
  long double balance_J = 0;   ///< sum of d'B d - f'd
  long double least_J = 0;     ///< its minimum so far
  long double turnover_J = 0;  ///< sum of |d'B d| + |f'd|: the scale of rounding errors
};

/// `dampings(tick)` holds from that tick on; `law` is called with position, request and damping and returns the force
/// applied to the device.
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

/// Hand and environment against a law: requests any force and moves so as to extract the most energy.
Extraction play(const AdversaryRun& run);

}  // namespace forcebound::test
