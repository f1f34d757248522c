#pragma once

#include "forcebound/record/session_state.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

using record::ForcePolicy;
using time::Nanoseconds;

/// Scales a force by the age of the motion that it answers: factor 1 up to `hold`, then falling linearly to 0 at
/// `drop`.
///
/// Hold, do not extrapolate: a guessed position can create energy.
struct LateForcePolicy {
  Nanoseconds hold = std::chrono::milliseconds{250};
  Nanoseconds drop = std::chrono::seconds{1};

  /// @throws std::invalid_argument unless 0 <= hold <= drop.
  void validate() const;

  /// Factor for the force, 0 to 1.
  [[nodiscard]] double scale(Nanoseconds age) const noexcept {
    if (age <= hold) return 1;
    if (age >= drop) return 0;
    return static_cast<double>((drop - age).count()) / static_cast<double>((drop - hold).count());
  }

  [[nodiscard]] ForcePolicy verdict(Nanoseconds age) const noexcept {
    if (age <= hold) return ForcePolicy::fresh;
    return age < drop ? ForcePolicy::fading : ForcePolicy::dropped;
  }
};

}  // namespace forcebound::client
