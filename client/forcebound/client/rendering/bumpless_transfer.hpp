#pragma once

#include "forcebound/control/vector.hpp"
#include "forcebound/local_model/no_longer_than.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

using control::Vector;
using time::Nanoseconds;

/// Where one source of forces takes over from another, the difference of what both request at that moment: the force
/// goes on from there, and the difference fades linearly. Longer than some 10 ms it would hide more than the step.
///
/// Real time: noexcept, no allocation.
class BumplessTransfer {
 public:
  static constexpr Nanoseconds kFade = std::chrono::milliseconds{10};

  /// @param force_N_max of the device: of both forces what it can show counts
  explicit BumplessTransfer(double force_N_max) noexcept : force_N_max_(force_N_max) {}

  /// From now on `next_N` is requested. @param until_now_N what would have been requested now, with what was left of an
  /// offset before
  void begin(const Vector& until_now_N, const Vector& next_N, Nanoseconds now) noexcept {
    offset_N_ =
        local_model::no_longer_than(until_now_N, force_N_max_) - local_model::no_longer_than(next_N, force_N_max_);
    since_ = now;
  }

  /// What is requested in place of `request_N`. As long as something fades, no more of it counts than the device can
  /// show: else a request beyond that would come at once.
  [[nodiscard]] Vector applied_to(const Vector& request_N, Nanoseconds now) noexcept {
    const Nanoseconds passed = now - since_;
    if (offset_N_.rows() != request_N.rows() || passed >= kFade || passed < Nanoseconds::zero()) {
      offset_N_.resize(0);
      return request_N;
    }
    return local_model::no_longer_than(request_N, force_N_max_) +
           (1 - time::to_seconds(passed) / time::to_seconds(kFade)) * offset_N_;
  }

 private:
  double force_N_max_;
  Vector offset_N_{};
  Nanoseconds since_{0};
};

}  // namespace forcebound::client
