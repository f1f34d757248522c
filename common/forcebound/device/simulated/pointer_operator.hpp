#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>

#include "forcebound/device/simulated/operator_settings.hpp"

namespace forcebound::device {

/// Where a person points to, for a hand that follows: written by any thread, read by the device's.
///
/// Each number is atomic by itself, so that a reading may mix the axes of two points; the hand follows smoothly, which
/// makes nothing of it. Real time: noexcept, no lock.
class PointerTarget {
 public:
  static constexpr int kAxes = 3;
  using Point = std::array<double, kAxes>;

  PointerTarget() noexcept = default;

  /// The hand holds firmly and goes there [m]. What is not finite is passed over.
  void point_to(const Point& place_m) noexcept;

  /// The hand loosens its grip, and stays where it is.
  void let_go() noexcept { held_.store(false, std::memory_order_relaxed); }

  void press(int button, bool down) noexcept;

  [[nodiscard]] bool held() const noexcept { return held_.load(std::memory_order_relaxed); }
  [[nodiscard]] Point place_m() const noexcept;
  [[nodiscard]] std::uint32_t buttons() const noexcept { return buttons_.load(std::memory_order_relaxed); }

 private:
  std::array<std::atomic<double>, kAxes> place_m_{};
  std::atomic<bool> held_{false};
  std::atomic<std::uint32_t> buttons_{0};
  static_assert(std::atomic<double>::is_always_lock_free);
};

/// A hand that follows a pointer, `pointer`: a spring and a damper from the tip to a point that another thread moves.
/// It begins at the offset and holds loosely, a tenth of its stiffness, until it is first pointed to and whenever it is
/// let go; so what pushes the device moves it visibly, and it does not drift away.
///
/// The point follows the pointer with a time constant, without overshoot, no faster than its speed and no farther from
/// the origin than its reach on each axis:
///
///     p'' = -2 w p' - w^2 (p - g),    |p - g| <= 2 speed / w
///
/// Unlike the other hands it moves as somebody else moves it: two runs are not alike.
class PointerOperator final : public SpecifiedOperator {
 public:
  PointerOperator(OperatorSettings settings, int dof);

  /// To be asked in the order of time, as a device does.
  [[nodiscard]] Target target(double time_s) const noexcept override;
  /// It has buttons always.
  [[nodiscard]] control::Handle handle(double time_s) const noexcept override;

  /// What moves it; shared with whoever points, so that it may outlive the device.
  [[nodiscard]] const std::shared_ptr<PointerTarget>& pointer() const noexcept { return pointer_; }

 private:
  struct State {
    double time_s = 0;
    Vector position;
    Vector velocity;
  };

  double speed_m_per_s_;
  double reach_m_;
  double rate_;  ///< w [1/s]
  std::shared_ptr<PointerTarget> pointer_ = std::make_shared<PointerTarget>();
  mutable State state_;  // of the device that owns it, on its thread
};

}  // namespace forcebound::device
