#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "forcebound/control/vector.hpp"

namespace forcebound::device {

using control::Vector;

/// For how long each joint's reading has been the same to the last bit, and how fast the joint was before.
///
/// An encoder that stands still repeats itself, and so does a driver whose bus has died behind it while it goes on to
/// stamp and to answer. What tells them apart without any force: two readings are off by half an encoder step each, so
/// that a joint whose reading changed by D within a time h was at least as fast as
///
///     v = (|D| - step) / h
///
/// on the average of that time. Over the last ten readings before it stood, that says whether the joint was on its way;
/// over the last two, whether it can have stayed within one step since: with a deceleration of at most a it had
/// w = v - a h/2 at the last change, and has gone w t - a t^2/2 in t <= w/a. If that is more than a step, the joint did
/// not stop: its reading did.
///
/// Real time: noexcept, no allocation, O(joints). Deterministic.
class RepeatedReadings {
 public:
  /// @param encoder_step of each joint; 0, or no rows: ideal
  explicit RepeatedReadings(const Vector& encoder_step) noexcept : step_(encoder_step) {}

  /// @param joint a usable reading @param elapsed_s since the one before, > 0
  void add(const Vector& joint, double elapsed_s) noexcept {
    const bool begins = past_.front().joint.rows() != joint.rows();
    if (begins) past_.fill({.time_s = time_s_, .joint = joint});
    if (!begins) time_s_ += elapsed_s;
    const Reading& last = past_.at(newest_);
    const Reading& first = past_.at((newest_ + 1) % kPast);
    for (Eigen::Index i = 0; i < joint.rows(); ++i) {
      Joint& seen = joints_.at(static_cast<std::size_t>(i));
      if (begins) {
        seen = {};
      } else if (joint[i] == last.joint[i]) {
        seen.still_s += elapsed_s;
      } else {
        seen = {.velocity = least_velocity(i, joint[i] - first.joint[i], time_s_ - first.time_s),
                .newest = least_velocity(i, joint[i] - last.joint[i], elapsed_s),
                .elapsed_s = elapsed_s};
      }
    }
    newest_ = (newest_ + 1) % kPast;
    past_.at(newest_) = {.time_s = time_s_, .joint = joint};
  }

  /// What was seen so far tells nothing of what comes.
  void restart() noexcept { past_.front().joint.resize(0); }

  /// 0: the newest reading is another one than that before.
  [[nodiscard]] double still_s(Eigen::Index joint) const noexcept { return of(joint).still_s; }

  /// Over the readings before its last change, least that explains them [rad/s] or [m/s]; 0: it may have stood.
  [[nodiscard]] double velocity(Eigen::Index joint) const noexcept { return of(joint).velocity; }

  /// Whether the joint cannot have stayed where its reading has. @param deceleration_most [rad/s^2] or [m/s^2]
  [[nodiscard]] bool cannot_have_stopped(Eigen::Index joint, double deceleration_most) const noexcept {
    const Joint& seen = of(joint);
    const double left = std::abs(seen.newest) - deceleration_most * seen.elapsed_s / 2;
    const double time_s = std::min(seen.still_s, left / deceleration_most);
    return time_s > 0 && (left - deceleration_most * time_s / 2) * time_s > step(joint);
  }

 private:
  struct Joint {
    double still_s = 0;
    double velocity = 0;
    double newest = 0;     ///< likewise of the last change alone,
    double elapsed_s = 0;  ///< which took so long
  };
  struct Reading {
    double time_s = 0;
    Vector joint{};
  };
  static constexpr std::size_t kPast = 10;

  [[nodiscard]] double least_velocity(Eigen::Index joint, double way, double elapsed_s) const noexcept {
    return std::copysign(std::max(0.0, std::abs(way) - step(joint)) / elapsed_s, way);
  }
  [[nodiscard]] double step(Eigen::Index joint) const noexcept { return joint < step_.rows() ? step_[joint] : 0; }
  [[nodiscard]] const Joint& of(Eigen::Index joint) const noexcept {
    return joints_.at(static_cast<std::size_t>(joint));
  }

  Vector step_;
  double time_s_ = 0;
  std::array<Reading, kPast> past_{};
  std::size_t newest_ = 0;
  std::array<Joint, control::kJointsMax> joints_{};
};

}  // namespace forcebound::device
