#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "forcebound/control/vector.hpp"
#include "forcebound/local_model/no_longer_than.hpp"

namespace forcebound::client {

/// Limits how fast a force [N] or torque [N m] may change, against servers that jerk. Honest contact at 0.3 m/s with a
/// wall of 10 N/mm is a change of 3 N in one tick, so there is no limit unless one is set.
///
/// Real time: noexcept, no allocation.
class RateLimiter {
 public:
  struct Limits {
    double slew_per_s = 0;  ///< 0: no limit
    /// Of the device: no time is spent beyond what it shows.
    double most = std::numeric_limits<double>::infinity();
  };
  explicit RateLimiter(const Limits& limits) noexcept : limits_(limits) {}

  [[nodiscard]] control::Vector limit(const control::Vector& request, double elapsed_s) noexcept {
    if (!(limits_.slew_per_s > 0)) return request;
    const control::Vector wanted = local_model::no_longer_than(request, limits_.most);
    if (last_.rows() != wanted.rows()) return last_ = wanted;
    const control::Vector step = wanted - last_;
    const double length = step.norm();
    // A reading may be from before an unusable one, which counts as of its tick.
    const double step_most = limits_.slew_per_s * std::max(0.0, elapsed_s);
    if (!(length > step_most)) return last_ = wanted;
    ++limited_;
    return last_ += step * (step_most / length);
  }

  /// Nothing is shown any more.
  void rest() noexcept { last_.setZero(); }

  /// How often it did.
  [[nodiscard]] std::uint64_t limited() const noexcept { return limited_; }

 private:
  Limits limits_;
  control::Vector last_{};
  std::uint64_t limited_ = 0;
};

}  // namespace forcebound::client
