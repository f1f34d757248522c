#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "forcebound/client/commands/identify/release_fit.hpp"
#include "forcebound/client/commands/identify/slide.hpp"
#include "forcebound/client/commands/identify/slide_energy.hpp"
#include "forcebound/client/commands/identify/usable_force.hpp"

namespace forcebound::client::commands::identify {

/// A lower bound with its estimate. Refused: no bound, and why.
struct LowerBound {
  double estimate = 0;
  double bound = 0;
  std::string refused{};

  /// What a law may rely on: 0 where refused.
  [[nodiscard]] double least() const noexcept { return refused.empty() ? bound : 0; }
};

/// The energy that one joint's slides took.
///
/// A slide begins at rest. What the motor has put in by then has gone into damping, friction and motion, whatever the
/// joint's load was on the way:
///
///     integral of F dx = D integral v^2 dt + c_place |way| + g way + m v^2 / 2
///
/// at the release and again at the end, when it has slowed down by itself: two equations for each slide, linear in what
/// is sought. The friction is one number for each part of the workspace, so that the least of them is a bound in all of
/// it. A weight g that pulls on the joint takes on the way back what it gave.
struct EnergyBalance {
  LowerBound damping{};                       ///< [N s/m], [N m s/rad]
  LowerBound friction{};                      ///< the least of all places [N], [N m]
  std::array<double, kPlaces> friction_at{};  ///< estimates
  double mass = 0;                            ///< [kg], [kg m^2]
  double mass_error = 0;                      ///< it is within so much of that, as sure as a bound is
  double weight = 0;                          ///< g: pulls backwards [N], [N m]
  UsableForce force{};
  double residual_share = 0;  ///< what the equations leave of the energy, root mean square
  double from = 0;            ///< the part of the workspace that was seen, from the joint's middle
  double to = 0;
  int slides = 0;
};

/// Mean force and speed of a slide: with constant force and no change of speed, force = friction + damping * speed.
struct SlidePoint {
  double speed = 0;  ///< integral of v^2 dt over the way
  double force = 0;  ///< energy taken over the way, the motion's at the end left out
  double direction = 1;
};

struct BalanceSettings {
  double encoder_step = 0;
  double latency_error_s = 0;  ///< the release may have been so much earlier or later
  double confidence = 0.99;    ///< of each bound
};

/// @param fit of the same slides
[[nodiscard]] EnergyBalance balance_energy(std::span<const Slide> slides, const ReleaseFit& fit,
                                           const BalanceSettings& settings);

/// For a figure.
[[nodiscard]] std::vector<SlidePoint> slide_points(std::span<const Slide> slides, const ReleaseFit& fit,
                                                   double encoder_step);

}  // namespace forcebound::client::commands::identify
