#pragma once

#include <memory>
#include <string>
#include <vector>

#include "forcebound/server/scene/scene_state.hpp"
#include "forcebound/time/clock.hpp"
#include "tests/lab/accuracy/richardson.hpp"

namespace forcebound::lab {

/// What a step takes, over many [us].
struct StepCost {
  double median_us = 0;
  double p99_us = 0;
  double max_us = 0;
};

/// @param durations_ns not empty
StepCost cost_of(const std::vector<double>& durations_ns);

/// A scene's answers along a way, one a tick: every setting at the same states.
struct Along {
  Forces forces{};
  std::vector<double> penetrations_m{};
  double work_J = 0;      ///< that the scene did on the device
  StepCost cost{};        ///< of the steps on which there was a force, if any
  std::string trouble{};  ///< empty: none; else why the run counts as failed or unconverged
};

/// @param positions_m one a millisecond
Along run_along(const std::shared_ptr<const server::Scene>& scene, const std::vector<Vector>& positions_m,
                const time::Clock& clock);

/// What the clock sees of a loop that always does the same for about so long: the machine's own noise.
StepCost idle_noise(double about_us, int times, const time::Clock& clock);

/// How far forces at the same states are from the reference.
struct StateError {
  double force = 0;                 ///< RMS of the difference over RMS of the reference
  double direction_median_deg = 0;  ///< over the states where both are more than a hundredth of the reference's RMS
  double direction_p95_deg = 0;
  double penetration_m = 0;                ///< mean over the states in contact
  double displayed_stiffness_N_per_m = 0;  ///< RMS of the force over that of the penetration
  double work_J = 0;                       ///< more than the reference's
};

StateError state_error(const Along& run, const Along& reference);

}  // namespace forcebound::lab
