#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/scene/scene_state.hpp"
#include "forcebound/time/clock.hpp"
#include "tests/tools/lab/accuracy/body_watch.hpp"
#include "tests/tools/lab/accuracy/richardson.hpp"

namespace forcebound::lab {

/// Time of a step, over many [us].
struct StepCost {
  double median_us = 0;
  double p99_us = 0;
  double max_us = 0;
  double spread_us = 0;  ///< the interquartile range
};

/// @param durations_ns not empty
StepCost cost_of(const std::vector<double>& durations_ns);

/// Work of a step, beside its time.
struct StepWork {
  std::optional<double> heap_operations{};  ///< mean; none: a sanitizer replaces malloc
  std::optional<double> instructions{};     ///< median; none: the kernel does not permit counting
};

/// A scene's answers along a path, one per tick.
struct Along {
  Forces forces{};
  std::vector<double> penetrations_m{};
  double work_J = 0;                   ///< that the scene did on the device
  StepCost cost{};                     ///< of the steps on which there was a force, if any
  StepWork per_step{};                 ///< of the same
  std::optional<BodyRecord> bodies{};  ///< of a scene that has some
  std::string trouble{};               ///< empty: none; else why the run counts as failed or unconverged
};

/// Why a state's answers are unreliable, by its own counters. Empty: no fault.
std::string trouble_of(const scene::SceneFaults& faults, std::size_t steps);

/// Runs the scene freely along the positions, with a state of its own. Bodies that step more rarely than the device
/// moves have the cost of the ticks on which they do.
/// @param positions_m one a millisecond
Along run_along(const std::shared_ptr<const scene::Scene>& scene, const std::vector<Vector>& positions_m,
                const time::Clock& clock);

/// Times of a loop of constant work of about that length: the machine's timing noise.
StepCost idle_noise(double about_us, int times, const time::Clock& clock);

/// Errors of forces at the same states against the reference.
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
