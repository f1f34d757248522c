#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "tests/tools/lab/trials/task.hpp"

namespace forcebound::lab {

/// A device that returned no more than this is passive, to rounding.
inline constexpr double kPassive_J = -1e-9;

/// Results of a law in one trial.
struct Trial {
  std::string refused;             ///< why the law cannot work with this device; otherwise empty, and the rest is known
  double passivity_minimum_J = 0;  ///< P of the audit
  bool calm = false;               ///< its contact came to rest: the force's peak-to-peak over 20 ms
  std::optional<double> ringing_s{};        ///< until then; nothing without contact
  double shown_N_per_m = std::nan("");      ///< displayed stiffness, median at rest; 0 without contact
  double force_N_mean = std::nan("");       ///< in contact
  double force_N2_variance = std::nan("");  ///< in contact
  double restlessness = std::nan("");  ///< deviation of the force's magnitude over its mean, once contact has settled
  double error = std::nan("");         ///< E_dev against the scene at the device's true position, at this moment
  double direction_error_rad = 0;      ///< largest angle between the applied and the requested force
  std::uint64_t law_faults = 0;        ///< ticks without a force of the law's, or one that is not finite
  double drift_m = 0;  ///< largest distance between the device and the position at which the environment was asked
};

/// Runs a trial in virtual time.
[[nodiscard]] Trial run_trial(const TrialSetup& setup);

/// Time of the law itself per tick [ns], over the motion and the requests of a trial. Not a number for a device that is
/// not Cartesian, and for a law with a server-side law, whose messages are not recorded.
/// @param clock the system's clock
[[nodiscard]] double work_ns(const TrialSetup& setup, const time::Clock& clock);

}  // namespace forcebound::lab
