#pragma once

#include <memory>
#include <vector>

#include "tests/tools/lab/accuracy/along.hpp"

namespace forcebound::lab {

/// Results of every setting of rigid bodies from the same states.
///
/// A reference runs along a path. Repeatedly its state is copied to all others (positions, velocities, solver's warm
/// start, couplings); then all make the same few ticks, and the results are compared. The number of ticks is the least
/// with whole steps of all settings and two of each: the force on the device is that of the probe's position as a step
/// began, so that the second step shows the result of the first.
struct Synchronised {
  int ticks = 1;            ///< from one saved state to the next
  std::vector<Along> runs;  ///< of each setting: forces and depths at the end of each
  /// Of each setting: distance of all velocities from the reference's, RMS over the RMS of the velocity changes by
  /// contacts in the reference, weighted by mass: |v|^2 = v' M v. The changes by contacts are those beyond a run
  /// without them, with M^-1 f of the last step of a tick for all of it.
  std::vector<double> velocity_errors;
};

/// @param reference which of the settings it is
/// @param positions_m one a millisecond
/// @return nothing where there is no state of all dynamic models to copy, as with tissue, which has none, or where the
/// settings are of different bodies.
std::optional<Synchronised> run_synchronised(const std::vector<std::shared_ptr<const scene::Scene>>& settings,
                                             std::size_t reference, const std::vector<Vector>& positions_m);

/// The least number of ticks of a millisecond with whole steps of all these lengths [s], and two of each; 20 if there
/// is none below.
int ticks_in_common(const std::vector<double>& steps_s);

}  // namespace forcebound::lab
