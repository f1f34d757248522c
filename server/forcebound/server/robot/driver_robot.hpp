#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "forcebound/driver/opened_driver.hpp"
#include "forcebound/driver/reading_times.hpp"
#include "forcebound/server/robot/robot.hpp"
#include "forcebound/server/robot/robot_description.hpp"
#include "forcebound/server/robot/serial_chain.hpp"

namespace forcebound::server {

/// A robot behind a driver of forcebound_device.h.
///
/// What the driver tells is checked before anybody sees it, as of a device (driver::DriverDevice): numbers that are not
/// finite, joints outside of what is possible, stamps that run backwards or lie in the future, and a driver that throws
/// are failed readings. A command is finite, and within the largest torques: beyond, all become shorter by one factor.
///
/// Where the robot does not compensate gravity, `apply` adds what holds its masses at the latest reading,
///
///     g_i(q) = sum over links j from i on of m_j g z'(axis_i x (centre_j - point_i)),
///
/// which is no part of what the law accounts for, as for any Robot. It is also held while its brakes open, and where
/// later readings are lost: an arm that is let go falls. Before the first good reading there is no command.
///
/// A sample of the force sensor counts for ten of its periods, or of the loop's if these are longer.
///
/// Only the thread of the robot's loop calls the driver, but for `stop`, which may come from any thread when that one
/// does not return from a call; from then on the robot counts as stopped. The call that was in progress then may have
/// ended after that stop, so the loop's thread stops the robot once more.
class DriverRobot final : public Robot {
 public:
  /// Opens it. @param own facts in place of those that the driver tells
  /// @throws std::runtime_error in one line: what the driver says, or what is wrong with its facts
  DriverRobot(std::shared_ptr<const driver::DriverLibrary> library, const driver::DriverRequest& request,
              std::optional<RobotDescription> own);

  [[nodiscard]] const control::DeviceFacts& facts() const noexcept override { return about_.facts; }
  [[nodiscard]] bool bounds_are_identified() const noexcept override { return about_.identified; }
  [[nodiscard]] std::string facts_in_words() const override;
  void start() override { opened_.start(); }
  device::Reading read(Nanoseconds now) noexcept override;
  void apply(Nanoseconds now, const Vector& torque) noexcept override;
  void stop(Nanoseconds now) noexcept override;
  [[nodiscard]] std::optional<Nanoseconds> effective_at() const noexcept override { return effective_at_; }
  [[nodiscard]] bool write_failed() const noexcept override { return write_failed_; }
  [[nodiscard]] std::optional<Nanoseconds> released_at() const noexcept override { return released_at_; }
  [[nodiscard]] std::optional<control::PassivityAudit> audit() const noexcept override { return audit_; }
  [[nodiscard]] device::DeviceCounters counters() const noexcept override { return counters_; }
  [[nodiscard]] std::string_view last_error() const noexcept override { return opened_.last_error(); }
  [[nodiscard]] std::string_view crash() const noexcept override { return driver::crash_in_words(); }

  [[nodiscard]] const RobotModel& model() const noexcept override { return chain_; }
  [[nodiscard]] std::optional<SensedForce> sensed_force() const noexcept override { return sensed_; }
  [[nodiscard]] std::optional<ForceSensorFacts> force_sensor() const noexcept override { return about_.sensor; }
  void command_gripper(Nanoseconds now, double opening) noexcept override;
  [[nodiscard]] std::optional<double> gripper() const noexcept override { return gripper_; }
  void soft_stop(Nanoseconds now) noexcept override;
  void resume(Nanoseconds now) noexcept override;
  [[nodiscard]] bool is_stopped() const noexcept override { return stopped_; }
  [[nodiscard]] bool compensates_gravity() const noexcept { return about_.compensates_gravity; }

 private:
  [[nodiscard]] const forcebound_driver& table() const noexcept { return opened_.functions(); }
  void apply_stop_from_outside() noexcept;
  [[nodiscard]] device::Reading reading_of(const forcebound_robot_reading& told, Nanoseconds now) noexcept;
  void store_reports(const forcebound_robot_reading& told, Nanoseconds now) noexcept;
  void store_sensed(const forcebound_robot_reading& told, Nanoseconds now) noexcept;
  void forget_old_sample(Nanoseconds now) noexcept;
  void apply_stop(Nanoseconds now) noexcept;
  [[nodiscard]] bool command(Nanoseconds now, const Vector& torque) noexcept;
  [[nodiscard]] device::Reading without_reading(device::Reading::Status status) const noexcept;
  [[nodiscard]] device::Reading refused(device::Reading::Status status, std::string_view why) noexcept;
  void store_failure(int result, std::string_view what) noexcept;

  driver::OpenedDriver opened_;
  RobotDescription about_;
  SerialChain chain_;
  control::Damping damping_;
  driver::ReadingTimes times_;
  Vector place_;  // joints, latest
  std::optional<Nanoseconds> effective_at_{};
  std::optional<Nanoseconds> released_at_{};
  std::optional<SensedForce> sensed_{};
  Nanoseconds sample_counts_{0};  // for so long
  std::optional<double> gripper_{};
  std::optional<double> opening_{};  // of the gripper, as commanded
  std::optional<control::PassivityAudit> audit_{};
  bool stopped_ = false;
  bool write_failed_ = false;
  std::optional<Nanoseconds> resumed_{};
  device::DeviceCounters counters_{};
  // By `stop` on another thread.
  std::atomic<bool> stopped_from_outside_{false};
};

/// Opens the robot of `FILE.so[:KEY=VALUE,...,facts=ROBOT.toml]`, or of a robot's file that names its driver; in a
/// child process first, so that a driver that crashes or never returns there ends that one alone.
/// @throws std::exception in one line
[[nodiscard]] std::unique_ptr<DriverRobot> open_robot(std::string_view file_and_settings);
[[nodiscard]] std::unique_ptr<DriverRobot> open_robot_of_file(const std::string& file);

}  // namespace forcebound::server
