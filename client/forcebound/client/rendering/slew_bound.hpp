#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "forcebound/control/vector.hpp"
#include "forcebound/local_model/no_longer_than.hpp"

namespace forcebound::client {

/// Bounds how fast a force may change, against servers that jerk. Honest contact at 0.3 m/s with a wall of 10 N/mm is a
/// change of 3 N in one tick, so there is no bound unless one is set.
///
/// Real time: noexcept, no allocation.
class SlewBound {
 public:
  struct Limits {
    double slew_N_per_s = 0;  ///< 0: no bound
    /// Of the device: the force does not spend time beyond what is shown.
    double force_N_max = std::numeric_limits<double>::infinity();
  };
  explicit SlewBound(const Limits& limits) noexcept : limits_(limits) {}

  [[nodiscard]] control::Vector bound(const control::Vector& request_N, double elapsed_s) noexcept {
    if (!(limits_.slew_N_per_s > 0)) return request_N;
    const control::Vector wanted_N = local_model::no_longer_than(request_N, limits_.force_N_max);
    if (last_N_.rows() != wanted_N.rows()) return last_N_ = wanted_N;
    const control::Vector step_N = wanted_N - last_N_;
    const double length_N = step_N.norm();
    // A reading may be from before an unusable one, which counts as of its tick.
    const double most_N = limits_.slew_N_per_s * std::max(0.0, elapsed_s);
    if (!(length_N > most_N)) return last_N_ = wanted_N;
    ++bounded_;
    return last_N_ += step_N * (most_N / length_N);
  }

  /// How often it did.
  [[nodiscard]] std::uint64_t bounded() const noexcept { return bounded_; }

 private:
  Limits limits_;
  control::Vector last_N_{};
  std::uint64_t bounded_ = 0;
};

}  // namespace forcebound::client
