#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "forcebound/control/energy_sum.hpp"
#include "forcebound/server/dynamics/bodies/mujoco.hpp"
#include "forcebound/server/robot/arm_mjcf.hpp"
#include "forcebound/server/robot/command_queue.hpp"
#include "forcebound/server/robot/force_sensor.hpp"
#include "forcebound/server/robot/friction_step.hpp"
#include "forcebound/server/robot/surroundings.hpp"
#include "forcebound/server/robot/task.hpp"
#include "forcebound/server/robot/task_watch.hpp"

namespace forcebound::server {

/// The seven-joint arm `reach-7` with a gripper and a force sensor, in the world of a task, simulated by the caller's
/// clock. MuJoCo has its geometry, masses and the forces of velocities; the step is our own, so that the energy balance
/// is known to the last digit:
///
///     M(q) (v+ - v)/h = tau - D v+ - c Sign(v+) - n(q, v) + J'F,      q+ = q + h v+        (semi-implicit Euler)
///
/// with the commanded torque tau, viscous damping D and dry friction c of the joints, both at the velocity at the
/// step's end (FrictionStep), the forces n of velocities, and the contact forces F of the beginning (Surroundings). A
/// joint that sticks does not creep at all.
///
/// **Gravity.** The robot compensates the weight of arm, gripper and tool in each step, exactly: both are left out. The
/// block has its weight.
///
/// **Audit.** In a step each joint moves by dq = h v+ at a constant speed, so that damping takes b dq^2/h, friction c
/// |dq| and the motors give tau dq, exactly: the audit is their sum, and between ticks it is linear in time, so that
/// its minimum is found at the ends of steps. Over several steps of a time t, sum b dq^2/h >= b (sum dq)^2/t and sum c
/// |dq| >= c |sum dq|: what a law credits for facts with this b and c is a true lower bound. Not in the audit, as none
/// of it is the motors' doing: the gripper, contacts, and the end stops. Brakes are in it, as more friction.
///
/// A step is never longer than `kStepMost`; commands, releases, and the caller's readings end one. So the motion
/// depends on the times of calls, but is the same for the same calls. An encoder is rounded to its step. Of a gap of
/// more than `kGapMax` between two calls only that long is simulated. If the simulation fails, readings fail from then
/// on.
///
/// Real time: all noexcept members but the constructor allocate nothing.
class SimulatedArm final : public TaskRobot {
 public:
  static constexpr Nanoseconds kStepMost = std::chrono::microseconds(500);
  static constexpr Nanoseconds kGapMax = std::chrono::seconds(10);

  /// The exact state, for tests and figures. No law may see it.
  struct Truth {
    Vector joint;
    Vector joint_velocity;
    double kinetic_J = 0;  ///< of arm and gripper
    BodyState tool{};
    BodyState block{};
  };

  /// @param seed of the sensor's noise and bias
  /// @throws std::runtime_error naming task and pose, if the start cannot be reached
  SimulatedArm(const Task& task, std::uint64_t seed);

  [[nodiscard]] const control::DeviceFacts& facts() const noexcept override { return facts_; }
  [[nodiscard]] bool is_simulated() const noexcept override { return true; }
  [[nodiscard]] std::string facts_in_words() const override;
  device::Reading read(Nanoseconds now) noexcept override;
  void apply(Nanoseconds now, const Vector& torque) noexcept override;
  [[nodiscard]] bool write_failed() const noexcept override { return write_failed_; }
  [[nodiscard]] std::optional<Nanoseconds> released_at() const noexcept override;
  [[nodiscard]] std::optional<control::PassivityAudit> audit() const noexcept override;
  [[nodiscard]] device::DeviceCounters counters() const noexcept override { return counters_; }
  [[nodiscard]] std::string_view last_error() const noexcept override { return error_; }

  [[nodiscard]] const RobotModel& model() const noexcept override { return chain_; }
  [[nodiscard]] std::optional<SensedForce> sensed_force() const noexcept override;
  [[nodiscard]] std::optional<ForceSensorFacts> force_sensor() const noexcept override { return sensor_.facts(); }
  void command_gripper(Nanoseconds now, double opening) noexcept override;
  [[nodiscard]] std::optional<double> gripper() const noexcept override;
  [[nodiscard]] std::optional<ToolPose> block() const noexcept override;
  void soft_stop(Nanoseconds now) noexcept override;
  void resume(Nanoseconds now) noexcept override;
  [[nodiscard]] bool is_stopped() const noexcept override { return stopped_; }

  [[nodiscard]] TaskProgress progress() const noexcept override { return watch_.progress(); }

  /// From now on somebody pushes the tool with this wrench: force [N] above torque about the tool's point [N m], world
  /// frame. The sensor feels it; the task does not count it. Not finite: ignored.
  void push(Nanoseconds now, const Vector6& wrench) noexcept;

  [[nodiscard]] Truth truth() const noexcept;

 private:
  void advance_to(Nanoseconds now) noexcept;
  void step(double step_s) noexcept;
  void find_tool_and_block() noexcept;
  void add_contacts(double step_s, Coordinates& force) noexcept;
  void add_servos(double step_s, CoordinateMatrix& a, Coordinates& force) const noexcept;
  void add_end_stops(Coordinates& force) const noexcept;
  void balance(double step_s) noexcept;
  void fail(std::string_view why) noexcept;

  ModelPointer model_;
  ArmLayout layout_;
  SerialChain chain_;
  control::DeviceFacts facts_;
  control::Damping damping_;
  Vector brakes_;  // friction of each joint's brake
  DataPointer data_;
  Surroundings surroundings_;
  TaskWatch watch_;
  CommandQueue commands_;
  ForceSensor sensor_;
  FrictionStep friction_;

  std::optional<Nanoseconds> origin_;
  Nanoseconds time_{0};  // since the origin, as are all of the parts above
  bool stopped_ = false;
  bool failed_ = false;  // the simulation
  bool write_failed_ = false;
  double opening_ = 0;  // of the gripper, as commanded
  ToolJacobian jacobian_;
  BodyState tool_;
  BodyState block_;
  Surroundings::Forces contact_;
  Vector6 push_{Vector6::Zero()};
  control::EnergySum energy_;
  double least_J_ = 0;
  device::DeviceCounters counters_;
  std::string_view error_;
};

}  // namespace forcebound::server
