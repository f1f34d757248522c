#pragma once

#include <cstdint>
#include <vector>

#include "tests/support/reference_laws.hpp"

namespace forcebound::test {

/// Settings of a random run of a law.
struct RandomRun {
  std::uint64_t seed = 1;
  int degrees_of_freedom = 3;
  int ticks = 1000;
  bool damping_changes = false;  ///< a new matrix on every tick
  double motion_m = 1e-3;        ///< size of a tick's motion
  double force_N = 20;           ///< size of a request
};

/// Motions and requests with a full damping matrix (eigenvalues about 1 to 30 N s/m): free space, walls soft and hard,
/// random forces, and times at which the device stands still. One seed gives one run.
std::vector<ReferenceTick> random_ticks(const RandomRun& run);

}  // namespace forcebound::test
