#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "tests/tools/lab/comparison/contest.hpp"

namespace forcebound::lab {

/// A device that returned no more than this is passive, to rounding.
inline constexpr double kPassive_J = -1e-9;

/// What a law showed in one contest.
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
  double direction_error_rad = 0;      ///< of the applied force against the one asked for, most
  double drift_m = 0;                  ///< between the device and where the environment was asked, most
};

/// Plays it, in virtual time.
[[nodiscard]] Trial play(const Contest& contest);

/// What the law itself takes a tick [ns], over the motion and the requests of a contest. Not a number for a device that
/// is not Cartesian, and for a law that is half at the server: what its server-side law says is not kept.
/// @param clock the machine's
[[nodiscard]] double work_ns(const Contest& contest, const time::Clock& clock);

}  // namespace forcebound::lab
