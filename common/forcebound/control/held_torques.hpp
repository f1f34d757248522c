#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "forcebound/control/vector.hpp"

namespace forcebound::control {

/// The torques in effect and on their way to the motors, from the present on.
///
/// A torque is in effect until the next one is, or the device lets go of it. Several are on their way at once where the
/// latency is longer than a tick; one for which there is no room takes the place of the newest; a device must do the
/// same.
///
/// Real time: noexcept, no allocation. A value.
class HeldTorques {
 public:
  static constexpr int kWaitingMax = 16;

  explicit HeldTorques(Eigen::Index joints) noexcept { held_[0].torque = Vector::Zero(joints); }

  /// A torque that is in effect from `after_s` on, but never before an earlier one, for `limit_s` at most.
  void command(const Vector& torque, double after_s, double limit_s) noexcept {
    if (last_ == kWaitingMax) --last_;
    const double begin_s = std::max(after_s, horizon_s());
    at(++last_) = {.torque = torque, .begin_s = begin_s, .limit_s = limit_s};
  }

  /// When the newest one takes effect [s from now].
  [[nodiscard]] double horizon_s() const noexcept { return last_ > 0 ? at(last_).begin_s : 0.0; }

  /// Calls `visit(torque, duration_s)` for each piece of the coming `duration_s` in which the torque is the same and
  /// not zero because let go of; for the others `visit(zero, duration_s)`. In the order of time.
  template <typename Visit>
  void each_piece(double duration_s, Visit&& visit) const noexcept {
    const Vector zero = Vector::Zero(held_[0].torque.rows());
    double now_s = 0;
    for (int i = 0; i <= last_ && now_s < duration_s; ++i) {
      const double end_s = i < last_ ? std::min(at(i + 1).begin_s, duration_s) : duration_s;
      if (end_s <= now_s) continue;
      const double held_s = std::clamp(at(i).limit_s - at(i).age_s, 0.0, end_s - now_s);
      if (held_s > 0) visit(at(i).torque, held_s);
      if (held_s < end_s - now_s) visit(zero, end_s - now_s - held_s);
      now_s = end_s;
    }
  }

  /// Lets so much time pass.
  void pass(double duration_s) noexcept {
    int gone = 0;
    while (gone < last_ && at(gone + 1).begin_s <= duration_s) ++gone;
    std::move(held_.begin() + gone, held_.begin() + last_ + 1, held_.begin());
    last_ -= gone;
    at(0).age_s += gone > 0 ? duration_s - at(0).begin_s : duration_s;
    for (int i = 1; i <= last_; ++i) at(i).begin_s -= duration_s;
  }

 private:
  struct Held {
    Vector torque;
    double begin_s = 0;  ///< from now; of no meaning for the one in effect
    double limit_s = std::numeric_limits<double>::infinity();
    double age_s = 0;
  };
  Held& at(int i) noexcept { return held_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Held& at(int i) const noexcept { return held_[static_cast<std::size_t>(i)]; }

  std::array<Held, kWaitingMax + 1> held_;  // the first is in effect
  int last_ = 0;
};

}  // namespace forcebound::control
