#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <string>

#include "forcebound/device/device_description.hpp"
#include "forcebound/device/haptic_device.hpp"
#include "forcebound/device/simulated/device_flaws.hpp"
#include "forcebound/device/simulated/joint_motion.hpp"
#include "forcebound/device/simulated/operator.hpp"

namespace forcebound::device {

/// A haptic device and the hand on it, simulated in continuous time by the caller's clock.
///
///     M q'' = tau - D q' - friction + J'(k_h (x_h - x) + b_h (x_h' - x') - m_h x'')
///
/// with the joints q, the tip x, the hand's target x_h(t), and tau = J(reading)'f held between commands. Where the tip
/// turns, J has rows for that, f a torque, and the hand a spring, a damper and an inertia of its own about them. The
/// motion
/// begins, at rest at the hand's first target, with the first reading or command. JointMotion integrates it without
/// time-stepping error, and fills the audit.
///
/// Hand: its target is sampled on a fixed grid of 1 ms from the start and is, by definition, the cubic through the
/// samples' positions and velocities. So the motion does not depend on the times of the readings. In joints: the hand's
/// coupling is linearised about the present configuration, at least once per ms (x = x0 + J (q - q0)). The audit
/// belongs to the motion that results, and stays exact for it. Velocity-dependent inertial forces are left out. There
/// are no mechanical stops: a hand that pulls out of reach stretches the mechanism, which stays finite there. Command:
/// takes effect the facts' latency after `apply`; the facts' hold time after that the device releases it, in the facts'
/// stages. One that is not finite or of the wrong size is zero force, and counted. With `DeviceFlaws` the device is not
/// as its facts say: motion and audit are the true ones, readings and reports are what the caller's clock and the
/// encoders make of them. A gap of more than `kGapMax` between two calls is simulated for that long only; device and
/// hand stand still for the rest, so that the work for a gap is bounded.
///
/// Real time: read and apply are noexcept and allocate nothing.
class SimulatedDevice final : public HapticDevice {
 public:
  static constexpr Nanoseconds kGapMax = std::chrono::seconds(60);

  /// The exact state, for tests and figures. No law may see it.
  struct Truth {
    Vector joint;
    Vector joint_velocity;
    Vector position;  ///< of the tip, scene frame [m]
    Vector velocity;  ///< likewise, as many rows [m/s]
    Vector turning;   ///< of a tip that turns, its rotation likewise [rad/s]; else no rows
  };

  /// @throws std::invalid_argument if the hand's degrees of freedom are not the device's, or if the device with this
  /// hand is too fast to follow (a time constant below 10 us).
  SimulatedDevice(DeviceDescription description, std::unique_ptr<const Operator> hand, const DeviceFlaws& flaws = {});

  [[nodiscard]] const control::DeviceFacts& facts() const noexcept override { return description_.facts; }
  [[nodiscard]] bool is_simulated() const noexcept override { return true; }
  [[nodiscard]] Safety safety() const noexcept override { return description_.safety; }
  [[nodiscard]] std::string facts_in_words() const override { return describe(description_); }
  [[nodiscard]] std::string hand_in_words() const override { return operator_->description(); }
  Reading read(Nanoseconds now) noexcept override;
  void apply(Nanoseconds now, const Vector& force_N) noexcept override;
  [[nodiscard]] std::optional<Nanoseconds> released_at() const noexcept override { return released_at_; }
  [[nodiscard]] std::optional<Nanoseconds> effective_at() const noexcept override { return effective_at_; }
  [[nodiscard]] bool write_failed() const noexcept override { return write_failed_; }
  [[nodiscard]] std::optional<control::PassivityAudit> audit() const noexcept override { return motion_.audit(); }

  [[nodiscard]] DeviceCounters counters() const noexcept override;

  [[nodiscard]] Truth truth() const noexcept;
  [[nodiscard]] const DeviceDescription& description() const noexcept { return description_; }
  [[nodiscard]] const Operator& hand() const noexcept { return *operator_; }
  /// Each motor makes so many times what it is told.
  [[nodiscard]] const Vector& motor_gain() const noexcept { return gain_; }

 private:
  static constexpr int kPendingMax = 256;
  struct Command {
    Nanoseconds effect{0};
    Vector torque;
  };

  void advance_to(Nanoseconds now) noexcept;
  void integrate(Nanoseconds length) noexcept;
  void enter_cell(std::int64_t cell) noexcept;
  void linearise() noexcept;
  [[nodiscard]] Matrix metric(double translation, double rotation) const noexcept;
  void turn_by_hand(JointDrive& drive, double elapsed_s) const noexcept;
  void change_torque() noexcept;
  void let_go() noexcept;
  [[nodiscard]] Nanoseconds true_time(Nanoseconds now) const noexcept;
  [[nodiscard]] Nanoseconds shown_time(Nanoseconds true_time) const noexcept;
  [[nodiscard]] Nanoseconds longest_piece() const noexcept;
  [[nodiscard]] double drawn(const control::Bracket& bracket) noexcept;
  [[nodiscard]] Nanoseconds drawn_s(const control::Bracket& bracket_s) noexcept;
  [[nodiscard]] Vector drawn_gain(Eigen::Index joints) noexcept;
  [[nodiscard]] double number(double low, double high) noexcept;
  void read_encoders(Vector& joint) noexcept;
  void move_motors(double length_s) noexcept;

  DeviceDescription description_;
  std::unique_ptr<const Operator> operator_;
  std::unique_ptr<const Kinematics> kinematics_;
  JointMotion motion_;
  control::Damping tip_damping_;

  DeviceFlaws flaws_;
  std::mt19937_64 random_;
  Vector gain_;         ///< of the motors
  Nanoseconds offset_;  ///< of the latency
  Vector lost_;         ///< counts, as positions

  // All times below are true and since the start, but for effective_at_ and released_at_, which are the caller's.
  std::optional<Nanoseconds> origin_;
  Nanoseconds time_{0};
  std::int64_t cell_ = -1;
  Operator::Target cell_start_;
  Operator::Target cell_end_;
  double grip_ = 1;
  Vector tip_;                                                      ///< where the hand's coupling is linearised
  Eigen::Quaterniond turn_start_ = Eigen::Quaterniond::Identity();  ///< that the hand wants, in this cell
  Eigen::Vector3d turn_rad_ = Eigen::Vector3d::Zero();              ///< from there to the cell's end
  Matrix jacobian_;                                                 ///< likewise
  Matrix reading_jacobian_;

  std::array<Command, kPendingMax> pending_;
  int pending_count_ = 0;
  Vector torque_;
  Vector command_;  ///< in effect; torque_ is what the motors make of it
  Vector lagged_;   ///< of that, without what is off
  std::optional<Nanoseconds> release_;
  std::optional<Nanoseconds> released_in_full_;
  bool write_failed_ = false;
  std::optional<Vector> framed_;             ///< joints as the bus latched them
  std::optional<Nanoseconds> effective_at_;  ///< of the last command
  std::optional<Nanoseconds> released_at_;   ///< likewise
  DeviceCounters counters_;
};

}  // namespace forcebound::device
