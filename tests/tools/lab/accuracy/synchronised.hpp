#pragma once

#include <memory>
#include <vector>

#include "tests/tools/lab/accuracy/along.hpp"

namespace forcebound::lab {

/// What every setting of rigid bodies makes of the very same states.
///
/// A reference runs along a way. Time and again all others are put where it is (positions, velocities, what solvers
/// remember, couplings); then all do the same few ticks, and what comes of it is compared. It is as few ticks as have
/// whole steps of all settings and two of each: the force on the device is of where a probe was as a step began, so
/// that it takes a second step to feel what the first one found.
struct Synchronised {
  int ticks = 1;            ///< from one saved state to the next
  std::vector<Along> runs;  ///< of each setting: forces and depths at the end of each
  /// Of each setting: how far all velocities are from the reference's then, RMS over RMS of what contacts changed
  /// there, weighted by mass:  |v|^2 = v' M v.  What contacts change is what is more than without them, with M^-1 f of
  /// the last step of a tick for all of it.
  std::vector<double> velocity_errors;
};

/// @param reference which of the settings it is
/// @param positions_m one a millisecond
/// @return nothing where there is no state of all dynamic models to copy, as with tissue, which has none, or where the
/// settings are of different bodies.
std::optional<Synchronised> run_synchronised(const std::vector<std::shared_ptr<const scene::Scene>>& settings,
                                             std::size_t reference, const std::vector<Vector>& positions_m);

/// The least number of ticks of a millisecond in which there are whole steps of all these lengths [s], and two of each;
/// where there is none up to 20, that.
int ticks_in_common(const std::vector<double>& steps_s);

}  // namespace forcebound::lab
