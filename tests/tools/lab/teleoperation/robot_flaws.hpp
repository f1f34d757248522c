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
};

/// A robot that is unplugged for a while: it returns no readings and takes no commands; the last one is released.
class FlawedRobot final : public server::TaskRobot {
 public:
  FlawedRobot(std::unique_ptr<server::TaskRobot> robot, const RobotFlaws& flaws)
      : robot_(std::move(robot)), flaws_(flaws) {}

  [[nodiscard]] const control::DeviceFacts& facts() const noexcept override { return robot_->facts(); }
  [[nodiscard]] bool is_simulated() const noexcept override { return robot_->is_simulated(); }
  void start() override { robot_->start(); }
  device::Reading read(Nanoseconds now) noexcept override {
    device::Reading reading = robot_->read(now);
    failed_ = now >= flaws_.unplugged_from && now < flaws_.unplugged_until;
    if (failed_) reading.status = device::Reading::Status::failed;
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
  [[nodiscard]] server::TaskProgress progress() const noexcept override { return robot_->progress(); }

 private:
  std::unique_ptr<server::TaskRobot> robot_;
  RobotFlaws flaws_;
  bool failed_ = false;
};

}  // namespace forcebound::lab
