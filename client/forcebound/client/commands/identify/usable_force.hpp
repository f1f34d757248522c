#pragma once

#include <vector>

#include "forcebound/client/commands/identify/slide_energy.hpp"

namespace forcebound::client::commands::identify {

/// What the largest pushes gave of what was commanded: share 0 where that could not be told.
struct UsableForce {
  double largest = 0;      ///< push that was commanded [N], [N m]
  double share = 0;        ///< of it that the motion shows
  double share_error = 0;  ///< it lies within so much of the truth, with the confidence of the bounds

  static constexpr double kSlack = 0.03;  ///< what no motion tells
  static constexpr double kWidest = 0.1;  ///< error beyond which nothing is told

  [[nodiscard]] bool falls_short() const noexcept { return share > 0 && share + share_error < 1 - kSlack; }
  [[nodiscard]] bool told() const noexcept { return share > 0 && share_error < kWidest; }
};

/// What the largest pushes gave, by what the smaller ones say of the joint: its mass, damping and friction are fitted
/// to slides with up to 60 % of the largest push alone, and with them the energy is computed that slides with 85 % and
/// more of it took. Motors that are too weak by the same share at all forces are not seen.
/// @param equations two of each slide, the second of its end
/// @param pushes of each slide
/// @param quantile of the error that is to be covered
[[nodiscard]] UsableForce usable_force(const std::vector<Equation>& equations, const std::vector<double>& pushes,
                                       double quantile);

}  // namespace forcebound::client::commands::identify
