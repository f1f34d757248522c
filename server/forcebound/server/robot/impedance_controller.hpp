#pragma once

#include <Eigen/Core>
#include <optional>

#include "forcebound/device/haptic_device.hpp"
#include "forcebound/server/robot/robot_model.hpp"
#include "forcebound/server/robot/velocity_filter.hpp"

namespace forcebound::server {

/// Where the tool shall be, and how fast it shall move there [m/s], [rad/s]; world frame.
struct ToolTarget {
  ToolPose pose;
  Eigen::Vector3d velocity{Eigen::Vector3d::Zero()};
  Eigen::Vector3d turn{Eigen::Vector3d::Zero()};
  Eigen::Vector3d push_N{Eigen::Vector3d::Zero()};  ///< that the tool shall exert beside spring and damper
};

/// How an ImpedanceController is tuned.
struct ImpedanceSettings {
  double stiffness_N_per_m = 2000;       ///< > 0
  double stiffness_N_m_per_rad = 100;    ///< > 0; not for robots of fewer than six joints
  double damping_ratio = 1;              ///< of the tool in free space, > 0; 1: critical
  double force_N_max = 60;               ///< of the spring's part, > 0: what a target far away can ask for
  double torque_N_m_max = 15;            ///< likewise
  double posture_stiffness_per_s2 = 20;  ///< of redundant joints towards the rest posture, per inertia, >= 0
  double posture_damping_ratio = 1;      ///< > 0
  double limit_zone = 0.15;              ///< joints are pushed back from this close to their limits on [rad], > 0
  double limit_torque_share = 0.5;       ///< with at most this share of the joint's largest torque, 0 to 1
  double singular_from = 0.06;           ///< smallest singular value of the scaled Jacobian below which damping sets in
  double velocity_cutoff_rad_per_s = 500;  ///< of the velocity filter, > 0
};

/// Operational-space impedance control [Khatib 1987]: a spring and damper between the tool and its target, whose
/// inertia is the tool's own.
///
///     e = [x_target - x; rotation vector from the tool's orientation to the target's]       world frame
///     tau = J'(K e + D (v_target - J q') + push) + N' M (k_p (q_rest - q) - d_p q') + limits
///
/// A robot of fewer than six joints cannot do both: its tool goes where it shall, and stands as that leaves it. Then e
/// and J have the three rows of the place, there is no spring or damper about the tool's point, and its joints' speeds
/// bound how fast it turns.
///
/// D is found from the inertia at the tool L = (J M^-1 J')^-1 so that K and L are damped by the given ratio in every
/// direction: with L = A A' and A^-1 K A^-T = U s U', D = 2 ratio A U sqrt(s) U' A' (double diagonalisation). N' = 1 -
/// J' L J M^-1 lets the posture accelerate nothing at the tool. Near a singular posture, where the smallest singular
/// value of J (with lengths scaled by 0.3 m) is below `singular_from`, L is damped least squares, (J M^-1 J' + lambda^2
/// W)^-1 [Nakamura and Hanafusa 1986], so that D stays bounded.
///
/// Bounds, in this order: K e, cut to `force_N_max` and `torque_N_m_max`; above the tool's largest speed only the part
/// of the force that slows it down is kept, and likewise for each joint; joints near a limit are pushed back by a
/// bounded spring and damper; last, all torques are scaled by one factor, so that none is above its largest.
///
/// Velocities come from the encoders by VelocityFilter. A reading that cannot be used: the torque is zero.
///
/// Real time: noexcept, no allocation. Not thread-safe; owned by the robot's loop.
class ImpedanceController {
 public:
  /// What was done at the latest call.
  struct Report {
    ToolPose pose{};                    ///< of the tool, by the reading
    Vector6 velocity{Vector6::Zero()};  ///< likewise, filtered
    Vector joint_velocity{};            ///< likewise; no rows: there was no usable reading
    Vector6 wrench{Vector6::Zero()};    ///< that the tool shall exert by spring and damper, before torques are scaled
    double smallest_singular = 0;
    bool singular = false;    ///< damped least squares was at work
    bool at_limit = false;    ///< a joint is within the limit zone
    bool too_fast = false;    ///< tool or a joint was above its largest speed
    double torque_share = 1;  ///< all torques were scaled by this
  };

  /// @throws std::invalid_argument naming the setting, its value and what is accepted. The model must outlive this.
  explicit ImpedanceController(const RobotModel& model, const ImpedanceSettings& settings = {});

  /// Joint torques towards the target; within the model's torque limits. Once for each reading.
  /// @param pose of the tool by that reading, where it is known already
  [[nodiscard]] Vector torque(const device::Reading& reading, const ToolTarget& target,
                              const std::optional<ToolPose>& pose = std::nullopt) noexcept;

  /// A soft stop by torque: damps every joint towards rest, with torques within the limits, from any state; holds
  /// nothing. Once for each reading, in place of `torque`.
  [[nodiscard]] Vector stopping_torque(const device::Reading& reading) noexcept;

  /// The next reading is not connected with those before: velocity starts at zero.
  void restart() noexcept;

  /// New stiffness and damping from the next call on. @throws as the constructor
  void set(const ImpedanceSettings& settings);

  [[nodiscard]] const Report& report() const noexcept { return report_; }
  [[nodiscard]] const ImpedanceSettings& settings() const noexcept { return settings_; }

  /// Whether it turns the tool as well as moving it.
  [[nodiscard]] bool turns() const noexcept { return settings_.stiffness_N_m_per_rad > 0; }

 private:
  [[nodiscard]] Eigen::Matrix<double, 6, 6> inertia_of(const ToolJacobian& jacobian, const Matrix& mass) noexcept;
  [[nodiscard]] Vector6 wrench_of(const Eigen::Matrix<double, 6, 6>& inertia, const ToolTarget& target) noexcept;
  void push_from_limits(const Vector& q, const Vector& velocity, Vector& torque) noexcept;
  [[nodiscard]] Vector within_torques(const Vector& torque) noexcept;

  const RobotModel& model_;
  ImpedanceSettings settings_;
  VelocityFilter velocity_;
  Report report_;
};

}  // namespace forcebound::server
