#pragma once

#include <memory>
#include <utility>

#include "forcebound/server/robot/task.hpp"

namespace forcebound::lab {

using time::Nanoseconds;

/// When a robot fails, and how.
struct RobotFlaws {
  Nanoseconds unplugged_from{Nanoseconds::max()};
  Nanoseconds unplugged_until{Nanoseconds::max()};
  Nanoseconds frozen_from{Nanoseconds::max()};  ///< its readings repeat the one before, with new stamps
  Nanoseconds frozen_until{Nanoseconds::max()};
};

/// A robot, or one at a task, that is unplugged for a while: it returns no readings and takes no commands; the last one
/// is released. Or one of which the readings freeze while it moves on.
template <typename Kind>
class FlawedRobotOf : public Kind {
 public:
  FlawedRobotOf(std::unique_ptr<Kind> robot, const RobotFlaws& flaws) : robot_(std::move(robot)), flaws_(flaws) {}

  /// Its joints at the latest reading, whatever that showed.
  [[nodiscard]] const control::Vector& truth() const noexcept { return truth_; }

  [[nodiscard]] const control::DeviceFacts& facts() const noexcept override { return robot_->facts(); }
  [[nodiscard]] bool is_simulated() const noexcept override { return robot_->is_simulated(); }
  void start() override { robot_->start(); }
  device::Reading read(Nanoseconds now) noexcept override {
    device::Reading reading = robot_->read(now);
    failed_ = now >= flaws_.unplugged_from && now < flaws_.unplugged_until;
    if (failed_) reading.status = device::Reading::Status::failed;
    truth_ = reading.joint;
    if (shown_.rows() > 0 && now >= flaws_.frozen_from && now < flaws_.frozen_until) freeze(reading);
    shown_ = reading.joint;
    return reading;
  }
  void apply(Nanoseconds now, const control::Vector& torque) noexcept override {
    if (!failed_) robot_->apply(now, torque);
  }
  void stop(Nanoseconds now) noexcept override { robot_->stop(now); }
  [[nodiscard]] std::optional<Nanoseconds> effective_at() const noexcept override { return robot_->effective_at(); }
  [[nodiscard]] bool write_failed() const noexcept override { return failed_ || robot_->write_failed(); }
  [[nodiscard]] std::optional<Nanoseconds> released_at() const noexcept override { return robot_->released_at(); }
  [[nodiscard]] std::optional<control::PassivityAudit> audit() const noexcept override { return robot_->audit(); }
  [[nodiscard]] device::DeviceCounters counters() const noexcept override { return robot_->counters(); }
  [[nodiscard]] std::string_view last_error() const noexcept override {
    return failed_ ? "the robot is unplugged" : robot_->last_error();
  }
  [[nodiscard]] const server::RobotModel& model() const noexcept override { return robot_->model(); }
  [[nodiscard]] std::optional<server::SensedForce> sensed_force() const noexcept override {
    return robot_->sensed_force();
  }
  [[nodiscard]] std::optional<server::ForceSensorFacts> force_sensor() const noexcept override {
    return robot_->force_sensor();
  }
  void command_gripper(Nanoseconds now, double opening) noexcept override {
    if (!failed_) robot_->command_gripper(now, opening);
  }
  [[nodiscard]] std::optional<double> gripper() const noexcept override { return robot_->gripper(); }
  [[nodiscard]] std::optional<server::ToolPose> block() const noexcept override { return robot_->block(); }
  void soft_stop(Nanoseconds now) noexcept override { robot_->soft_stop(now); }
  void resume(Nanoseconds now) noexcept override { robot_->resume(now); }
  [[nodiscard]] bool is_stopped() const noexcept override { return robot_->is_stopped(); }

 protected:
  [[nodiscard]] const Kind& robot() const noexcept { return *robot_; }

 private:
  void freeze(device::Reading& reading) const noexcept {
    reading.joint = shown_;
    reading.position = shown_;
  }

  std::unique_ptr<Kind> robot_;
  RobotFlaws flaws_;
  control::Vector truth_{};
  control::Vector shown_{};
  bool failed_ = false;
};

class FlawedRobot final : public FlawedRobotOf<server::TaskRobot> {
 public:
  using FlawedRobotOf::FlawedRobotOf;
  [[nodiscard]] server::TaskProgress progress() const noexcept override { return robot().progress(); }
};

}  // namespace forcebound::lab
