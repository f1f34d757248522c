#pragma once

#include <algorithm>

namespace forcebound::device {

/// From 0 to 1 while s goes from 0 to 1, at rest and without acceleration at both ends: 10 s^3 - 15 s^4 + 6 s^5.
struct SmoothStep {
  double value;     ///< S(s)
  double slope;     ///< dS / ds
  double integral;  ///< of S from 0 to s
};

inline SmoothStep smooth_step(double s) noexcept {
  const double u = std::clamp(s, 0.0, 1.0);
  const double square = u * u;
  return {.value = square * u * (10 + u * (6 * u - 15)),
          .slope = 30 * square * (1 - u) * (1 - u),
          .integral = square * square * (2.5 + u * (u - 3)) + std::max(s - 1, 0.0)};
}

}  // namespace forcebound::device
