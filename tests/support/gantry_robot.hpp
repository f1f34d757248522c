#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "forcebound/server/robot/robot.hpp"

namespace forcebound::test {

using control::Matrix;
using control::Vector;
using time::Nanoseconds;

/// Three sliding axes with mass and viscous damping, before a wall at x >= `wall_m`.
struct GantrySettings {
  double mass_kg = 2;
  double damping_N_s_per_m = 20;
  double encoder_step_m = 1e-6;
  double wall_m = 0.02;
  double wall_N_per_m = 5000;
  double force_N_max = 60;
  double force_N_per_s_max = 0;  ///< that it says; 0: at once
  Nanoseconds latency{300'000};
  bool has_sensor = true;
  double speed_m_per_s_max = 2;  ///< of an axis, that it says
  double highest_m = 0.5;        ///< likewise
  double push_N = 0;             ///< of somebody, along y
  double stiction_N = 0;         ///< dry friction of each axis, of which it says nothing
};

class GantryModel final : public server::RobotModel {
 public:
  explicit GantryModel(const GantrySettings& settings) : mass_kg_(settings.mass_kg), rest_(Vector::Zero(3)) {
    limits_ = {.lowest = Vector::Constant(3, -0.5),
               .highest = Vector::Constant(3, settings.highest_m),
               .speed_max = Vector::Constant(3, settings.speed_m_per_s_max),
               .torque_max = Vector::Constant(3, settings.force_N_max),
               .torque_rate_max = Vector::Constant(3, settings.force_N_per_s_max),
               .tool_speed_m_per_s_max = 1,
               .tool_turn_rad_per_s_max = 1};
  }
  [[nodiscard]] std::string_view name() const noexcept override { return "gantry"; }
  [[nodiscard]] int joints() const noexcept override { return 3; }
  [[nodiscard]] server::ToolPose pose(const Vector& q) const noexcept override { return {.position = q}; }
  [[nodiscard]] server::ToolJacobian jacobian(const Vector& /*q*/) const noexcept override {
    server::ToolJacobian j = server::ToolJacobian::Zero(6, 3);
    j.topRows<3>().setIdentity();
    return j;
  }
  [[nodiscard]] Matrix mass_matrix(const Vector& /*q*/) const noexcept override {
    return mass_kg_ * Matrix::Identity(3, 3);
  }
  [[nodiscard]] const server::RobotLimits& limits() const noexcept override { return limits_; }
  [[nodiscard]] const Vector& rest() const noexcept override { return rest_; }

 private:
  double mass_kg_;
  server::RobotLimits limits_;
  Vector rest_;
};

/// Integrated in steps of 50 us; the audit is that of these very steps.
class GantryRobot : public server::Robot {
 public:
  explicit GantryRobot(const GantrySettings& settings = {}) : settings_(settings), model_(settings) {
    facts_.name = "gantry";
    facts_.damping = settings.damping_N_s_per_m * Matrix::Identity(3, 3);
    facts_.friction = Vector::Zero(3);
    facts_.encoder_step = Vector::Constant(3, settings.encoder_step_m);
    facts_.actuator_step = Vector::Zero(3);
    facts_.force_N_max = settings.force_N_max;
    facts_.latency_s = time::to_seconds(settings.latency);
    damping_ = std::make_unique<control::Damping>(control::Damping::from_matrix(facts_.damping));
  }

  [[nodiscard]] const control::DeviceFacts& facts() const noexcept override { return facts_; }
  [[nodiscard]] bool is_simulated() const noexcept override { return true; }
  [[nodiscard]] const server::RobotModel& model() const noexcept override { return model_; }

  device::Reading read(Nanoseconds now) noexcept override {
    advance(now);
    device::Reading reading;
    if (unplugged) {
      reading.status = device::Reading::Status::failed;
      return reading;
    }
    const double step = settings_.encoder_step_m;
    reading.position = q_;
    if (step > 0) reading.position = (q_ / step).array().round() * step;
    reading.joint = reading.position;
    reading.jacobian = Matrix::Identity(3, 3);
    reading.damping = damping_.get();
    reading.latched = now;
    return reading;
  }
  void apply(Nanoseconds now, const Vector& force_N) noexcept override {
    advance(now);
    fastest_rise_N_ = std::max(fastest_rise_N_, (force_N.cwiseAbs() - commanded_N_.cwiseAbs()).maxCoeff());
    commanded_N_ = force_N;
    // Far more than can wait at any rate of ticks.
    if (waiting_ < commands_.size()) {
      commands_.at(waiting_++) = {now + settings_.latency, stopped_ ? Vector(Vector::Zero(3)) : force_N};
    }
  }
  [[nodiscard]] std::optional<Nanoseconds> released_at() const noexcept override { return std::nullopt; }
  [[nodiscard]] std::optional<control::PassivityAudit> audit() const noexcept override { return audit_; }

  [[nodiscard]] std::optional<server::ForceSensorFacts> force_sensor() const noexcept override {
    if (!settings_.has_sensor) return std::nullopt;
    return server::ForceSensorFacts{.period = std::chrono::milliseconds{1}};
  }
  [[nodiscard]] std::optional<server::SensedForce> sensed_force() const noexcept override {
    if (!settings_.has_sensor) return std::nullopt;
    return server::SensedForce{.force_N = Eigen::Vector3d(-wall_force_N(), 0, 0) + drift_N, .sampled = now_};
  }
  void command_gripper(Nanoseconds /*now*/, double opening) noexcept override { gripper_command = opening; }
  [[nodiscard]] std::optional<double> gripper() const noexcept override {
    return std::max(gripper_command.value_or(1), held_opening);
  }
  void soft_stop(Nanoseconds now) noexcept override {
    advance(now);
    stopped_ = true;
    waiting_ = 0;
    force_.setZero();
  }
  void resume(Nanoseconds /*now*/) noexcept override { stopped_ = false; }
  [[nodiscard]] bool is_stopped() const noexcept override { return stopped_; }

  [[nodiscard]] const Vector& place_m() const noexcept { return q_; }
  [[nodiscard]] const Vector& velocity_m_per_s() const noexcept { return v_; }
  [[nodiscard]] double wall_force_N() const noexcept {
    return -settings_.wall_N_per_m * std::max(0.0, q_[0] - settings_.wall_m);
  }

  /// By which a force grew at most from one command to the next.
  [[nodiscard]] double fastest_rise_N() const noexcept { return fastest_rise_N_; }

  bool unplugged = false;
  Eigen::Vector3d drift_N{Eigen::Vector3d::Zero()};  ///< of its sensor
  std::optional<double> gripper_command{};           ///< none: never commanded, and open
  double held_opening = 0;                           ///< what is between its fingers keeps them so far open

 private:
  struct Command {
    Nanoseconds effect{0};
    Vector force;
  };

  void advance(Nanoseconds now) noexcept {
    constexpr Nanoseconds kStep{50'000};
    // A real clock began long ago.
    if (!std::exchange(began_, true)) now_ = now;
    for (; now_ < now; now_ += kStep) {
      while (waiting_ > 0 && commands_.front().effect <= now_) {
        force_ = commands_.front().force;
        effect_ = commands_.front().effect;
        std::copy(commands_.begin() + 1, commands_.begin() + static_cast<std::ptrdiff_t>(waiting_), commands_.begin());
        --waiting_;
      }
      if (now_ - effect_ > time::from_seconds(facts_.hold_s_max)) force_.setZero();
      step(time::to_seconds(kStep));
    }
  }

  /// Damping implicit, so that it dissipates b v^2 with the v of the step.
  void step(double h) noexcept {
    constexpr double kBrake_N_s_per_m = 200;
    const double b = settings_.damping_N_s_per_m + (stopped_ ? kBrake_N_s_per_m : 0);
    Vector force = force_;
    force[0] += wall_force_N();
    force[1] += settings_.push_N;
    v_ = (settings_.mass_kg * v_ + h * force) / (settings_.mass_kg + h * b);
    for (double& axis : v_) {
      const double taken = h * settings_.stiction_N / settings_.mass_kg;
      axis -= std::clamp(axis, -taken, taken);
    }
    q_ += h * v_;
    audit_.energy_J += h * (settings_.damping_N_s_per_m * v_.squaredNorm() - force_.dot(v_));
    audit_.minimum_J = std::min(audit_.minimum_J, audit_.energy_J);
  }

  GantrySettings settings_;
  GantryModel model_;
  control::DeviceFacts facts_;
  std::unique_ptr<control::Damping> damping_;
  Vector q_ = Vector::Zero(3);
  Vector v_ = Vector::Zero(3);
  Vector force_ = Vector::Zero(3);
  Vector commanded_N_ = Vector::Zero(3);
  double fastest_rise_N_ = 0;
  std::array<Command, 64> commands_{};
  std::size_t waiting_ = 0;
  bool began_ = false;
  Nanoseconds now_{0};
  Nanoseconds effect_{0};
  bool stopped_ = false;
  control::PassivityAudit audit_;
};

}  // namespace forcebound::test
