#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace forcebound::server {

/// What opening a robot's gripper is commanded, 0: closed, 1: open, without a jump when somebody begins to lead it:
/// bumpless transfer.
///
/// The gripper may hold something then, and the operator's grip be anywhere. So the command stays until the operator's
/// grip is within kMet of it, or passes it. From there on it goes where the grip goes; what was left between the two
/// ends as the grip moves, so that there is no step. A button's grip is closed or open, and meets likewise.
///
/// Real time: noexcept, no allocation.
class Grip {
 public:
  static constexpr double kMet = 0.05;

  /// Somebody begins to lead. @param opening that the gripper has, which counts as its command where there was none
  /// yet; none: it has no gripper
  void begin(std::optional<double> opening) noexcept {
    if (!commanded_) commanded_ = opening;
    met_ = !commanded_;
    before_.reset();
    apart_ = 0;
  }

  /// @param wanted opening of the operator's grip. @return what to command; none: nothing, the two have not met yet
  std::optional<double> follow(double wanted) noexcept {
    if (!(wanted >= 0 && wanted <= 1)) return std::nullopt;
    const double before = std::exchange(before_, wanted).value_or(wanted);
    if (met_) {
      constexpr double kEnds = 0.5;  // so much of what is left, as a share of the grip's own way
      const double left = std::max(0.0, std::abs(apart_) - kEnds * std::abs(wanted - before));
      apart_ = std::copysign(left, apart_);
    } else {
      const double apart = wanted - *commanded_;
      const bool passed = (before - *commanded_) * apart < 0;
      met_ = passed || std::abs(apart) <= kMet;
      apart_ = passed ? 0 : apart;
    }
    if (!met_) return std::nullopt;
    commanded_ = std::clamp(wanted - apart_, 0.0, 1.0);
    return commanded_;
  }

  /// Whether something keeps the gripper at this opening, wider than it was commanded.
  [[nodiscard]] bool holds(double opening) const noexcept { return commanded_ && opening > *commanded_ + kMet; }

  /// Whether the gripper stays, for the two have not met yet.
  [[nodiscard]] bool waits() const noexcept { return !met_ && before_; }

 private:
  std::optional<double> commanded_;
  std::optional<double> before_;  // of the grip, while this operator leads
  double apart_ = 0;              // from the command to the grip
  bool met_ = true;
};

}  // namespace forcebound::server
