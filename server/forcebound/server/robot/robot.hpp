#pragma once

#include <Eigen/Core>
#include <chrono>
#include <optional>

#include "forcebound/device/haptic_device.hpp"
#include "forcebound/server/robot/robot_model.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

using time::Nanoseconds;

/// A sample of the sensor between the robot's flange and its tool: what the tool exerts on its surroundings, without
/// the tool's own weight and inertia. World frame, torque about the tool's point; with the sensor's noise and bias.
struct SensedForce {
  Eigen::Vector3d force_N{Eigen::Vector3d::Zero()};
  Eigen::Vector3d torque_N_m{Eigen::Vector3d::Zero()};
  Nanoseconds sampled{0};  ///< when, by the caller's clock
};

/// What is known of a robot's force sensor.
struct ForceSensorFacts {
  Nanoseconds period{0};    ///< from sample to sample
  double noise_N_sd = 0;    ///< standard deviation of each axis, white
  double noise_N_m_sd = 0;  ///< likewise
  double bias_N_max = 0;    ///< of each axis, constant from `start` on
  double bias_N_m_max = 0;  ///< likewise
};

/// Brakes that are not open so long after `resume` stay closed.
constexpr Nanoseconds kBrakesOpenWithin = std::chrono::seconds{2};

/// A robot at work, driven through the interface of devices, in its joints: `facts()` have a row for each joint and
/// call it Cartesian, so that position and joint of a reading are both q, and a command is a torque for each joint
/// ([rad] and [N m]; [m] and [N] for a sliding joint).
///
/// `apply` commands torques *beyond* what the robot needs to hold itself, its gripper and tool against gravity: it
/// compensates that itself, at its own rate, as robots with a torque interface do. That work is no part of the energy
/// balance of `audit`, which has the commanded torques alone. A torque beyond `model().limits().torque_max` makes all
/// torques of that command shorter by one factor; a law must know that one, so ask for no more.
///
/// As of any device: it dissipates at least what `facts()` say, holds a command until the next one takes effect and at
/// most for the hold time. `effective_at` and `released_at` are as there.
///
/// Real time as HapticDevice; what is added here allocates nothing either.
class Robot : public device::HapticDevice {
 public:
  [[nodiscard]] virtual const RobotModel& model() const noexcept = 0;

  /// Newest sample until the latest reading or command; none: there is no sensor, or no sample that is new enough to
  /// tell what the tool touches now.
  [[nodiscard]] virtual std::optional<SensedForce> sensed_force() const noexcept { return std::nullopt; }

  /// None: it has no sensor.
  [[nodiscard]] virtual std::optional<ForceSensorFacts> force_sensor() const noexcept { return std::nullopt; }

  /// From now on the gripper moves towards this opening, 0: closed, 1: open, at its own speed and with its own largest
  /// force. Clamped; not a number: ignored. Without a gripper nothing happens. What the gripper does is not in `audit`.
  virtual void command_gripper(Nanoseconds now, double opening) noexcept { (void)now, (void)opening; }

  /// 0 to 1; none: it has no gripper. `Reading::handle.gripper` has it too.
  [[nodiscard]] virtual std::optional<double> gripper() const noexcept { return std::nullopt; }

  /// Where the block of a simulated task is, for pictures alone; none: there is none, or nobody knows.
  [[nodiscard]] virtual std::optional<ToolPose> block() const noexcept { return std::nullopt; }

  /// The robot's own stop, for a leader that is silent and faults of ours: drops the commanded torque and brings all
  /// joints to rest by brakes, which slip at a torque that a person can stand beside, and which then hold. Brakes only
  /// take energy. Commands are ignored until `resume`. May be called in any state.
  virtual void soft_stop(Nanoseconds now) noexcept = 0;

  /// Opens the brakes. The torque is zero until the next command.
  virtual void resume(Nanoseconds now) noexcept = 0;

  [[nodiscard]] virtual bool is_stopped() const noexcept = 0;
};

}  // namespace forcebound::server
