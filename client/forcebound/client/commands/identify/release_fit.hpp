#pragma once

#include <optional>
#include <span>
#include <vector>

#include "forcebound/client/commands/identify/release_state.hpp"
#include "forcebound/client/commands/identify/slide.hpp"

namespace forcebound::client::commands::identify {

/// An estimate and its standard error.
struct Estimate {
  double value = 0;
  double error = 0;
  double slides = 0;  ///< that tell it, as if all told as much of it
};

/// What the slides of one joint say in the time around their release, where the constant force ends in mid-motion:
///
///     m v' = F - c - D v  until the release takes effect,  m v' = -c - D v  afterwards
///
/// so that position and velocity have no step, and the acceleration has one of F/m at the time sought. Position and
/// velocity at the release belong to each slide, all else to the joint; the friction to each direction, so that a
/// weight that pulls on the joint does no harm.
struct ReleaseFit {
  double mass = 0;                     ///< [kg], [kg m^2]
  double damping = 0;                  ///< [N s/m], [N m s/rad]
  double friction = 0;                 ///< mean of both directions [N], [N m]
  double weight = 0;                   ///< half their difference: what pulls backwards
  Estimate latency_s{};                ///< from a command to its effect
  std::optional<Estimate> hold_s{};    ///< from the effect of the last command to the end of the force
  double residual = 0;                 ///< root mean square, in encoder steps; rounding alone makes 0.29
  int slides = 0;                      ///< that were used
  std::vector<ReleaseState> states{};  ///< for each slide
};

/// What is believed before: where the fit begins.
struct JointGuess {
  double mass = 0;
  double damping = 0;
  double friction = 0;
  double latency_s = 0.5e-3;
  std::optional<double> hold_s{};
};

/// Whether a slide that was let go by silence moves to its end as if it were still pushed, rather than freely.
[[nodiscard]] bool still_pushed(const Slide& slide, const JointGuess& guess) noexcept;

/// Gauss-Newton; standard errors from the scatter from slide to slide, so that what the model leaves out of a slide
/// counts as well.
/// @returns nothing with fewer than four usable slides, or if it does not converge
[[nodiscard]] std::optional<ReleaseFit> fit_releases(std::span<const Slide> slides, double encoder_step,
                                                     const JointGuess& guess);

}  // namespace forcebound::client::commands::identify
