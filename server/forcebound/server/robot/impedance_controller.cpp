#include "forcebound/server/robot/impedance_controller.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/local_model/no_longer_than.hpp"
#include "forcebound/server/robot/inverse_kinematics.hpp"

namespace forcebound::server {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Compares turning with moving: the length of a wrist.
constexpr double kScale_m = 0.3;

struct Setting {
  std::string_view name;
  double value;
  bool zero_allowed = false;
};

void check(const ImpedanceSettings& settings) {
  const auto refuse = [](const Setting& setting, const char* accepted) {
    control::ClassicText text;
    text << "impedance control: " << setting.name << " must be " << accepted << ", got " << setting.value;
    throw std::invalid_argument(text.str());
  };
  for (const Setting& setting :
       {Setting{"stiffness_N_per_m", settings.stiffness_N_per_m},
        Setting{"stiffness_N_m_per_rad", settings.stiffness_N_m_per_rad},
        Setting{"damping_ratio", settings.damping_ratio}, Setting{"force_N_max", settings.force_N_max},
        Setting{"torque_N_m_max", settings.torque_N_m_max},
        Setting{"posture_stiffness_per_s2", settings.posture_stiffness_per_s2, true},
        Setting{"posture_damping_ratio", settings.posture_damping_ratio}, Setting{"limit_zone", settings.limit_zone},
        Setting{"limit_torque_share", settings.limit_torque_share, true},
        Setting{"singular_from", settings.singular_from, true},
        Setting{"velocity_cutoff_rad_per_s", settings.velocity_cutoff_rad_per_s}}) {
    const bool holds =
        std::isfinite(setting.value) && (setting.value > 0 || (setting.zero_allowed && setting.value == 0));
    if (!holds) refuse(setting, setting.zero_allowed ? ">= 0 and finite" : "> 0 and finite");
  }
  if (settings.limit_torque_share > 1) refuse({"limit_torque_share", settings.limit_torque_share}, "0 to 1");
}

constexpr Eigen::Index kFullTask = 6;  // joints that it takes to place and turn a tool

/// As a robot of so many joints can have them.
ImpedanceSettings checked(const ImpedanceSettings& settings, Eigen::Index joints) {
  check(settings);
  ImpedanceSettings possible = settings;
  if (joints < kFullTask) possible.stiffness_N_m_per_rad = 0;
  return possible;
}

/// Of the rows that are not zero as a whole.
double smallest_singular_of(const ToolJacobian& jacobian, bool turns) noexcept {
  ToolJacobian scaled = jacobian;
  scaled.topRows<3>() /= kScale_m;
  const Matrix6 square = scaled * scaled.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(square, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[turns ? 0 : 3]));
}

/// 2 ratio A U sqrt(s) U' A', which damps every direction of K with the inertia A A' by the ratio.
Matrix6 damping_of(const Matrix6& inertia, const Vector6& stiffness, double ratio) noexcept {
  const Eigen::LLT<Matrix6> factor(inertia);
  const Matrix6 a = factor.matrixL();
  const Matrix6 half = factor.matrixL().solve(Matrix6(stiffness.asDiagonal()));
  const Matrix6 scaled = factor.matrixL().solve(half.transpose());
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(0.5 * (scaled + scaled.transpose()));
  const Vector6 roots = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const Matrix6 shape = a * eigen.eigenvectors();
  return 2 * ratio * shape * roots.asDiagonal() * shape.transpose();
}

/// Without what would make it faster, where it is too fast already.
bool slow_down(Eigen::Ref<Eigen::Vector3d> force, const Eigen::Vector3d& velocity, double fastest) noexcept {
  const double speed = velocity.norm();
  if (speed <= fastest) return false;
  const Eigen::Vector3d along = velocity / speed;
  force -= std::max(0.0, along.dot(force)) * along;
  return true;
}

}  // namespace

ImpedanceController::ImpedanceController(const RobotModel& model, const ImpedanceSettings& settings)
    : model_(model), settings_(checked(settings, model.joints())), velocity_(settings.velocity_cutoff_rad_per_s) {}

void ImpedanceController::set(const ImpedanceSettings& settings) {
  const ImpedanceSettings possible = checked(settings, model_.joints());
  if (possible.velocity_cutoff_rad_per_s != settings_.velocity_cutoff_rad_per_s) {
    velocity_ = VelocityFilter(possible.velocity_cutoff_rad_per_s);
  }
  settings_ = possible;
}

void ImpedanceController::restart() noexcept { velocity_.restart(); }

Vector ImpedanceController::torque(const device::Reading& reading, const ToolTarget& target,
                                   const std::optional<ToolPose>& pose) noexcept {
  report_ = {};
  const Eigen::Index joints = model_.joints();
  if (!device::is_usable(reading, model_.joints())) {
    restart();
    return Vector::Zero(joints);
  }
  const Vector& q = reading.joint;
  const Vector velocity = velocity_.update(reading.latched, q);
  ToolJacobian jacobian = model_.jacobian(q);
  const Matrix mass = model_.mass_matrix(q);
  report_.pose = pose ? *pose : model_.pose(q);
  report_.velocity = jacobian * velocity;
  if (!turns()) jacobian.bottomRows<3>().setZero();
  report_.joint_velocity = velocity;
  const Matrix6 inertia = inertia_of(jacobian, mass);
  report_.wrench = wrench_of(inertia, target);
  const Vector accelerate =
      settings_.posture_stiffness_per_s2 * (model_.rest() - q) -
      2 * settings_.posture_damping_ratio * std::sqrt(settings_.posture_stiffness_per_s2) * velocity;
  const Vector6 seen_at_tool = inertia * (jacobian * accelerate);
  Vector torque = jacobian.transpose() * (report_.wrench - seen_at_tool) + mass * accelerate;
  push_from_limits(q, velocity, torque);
  for (Eigen::Index i = 0; i < joints; ++i) {
    const bool too_fast = std::abs(velocity[i]) > model_.limits().speed_max[i];
    report_.too_fast = report_.too_fast || too_fast;
    if (too_fast && torque[i] * velocity[i] > 0) torque[i] = 0;
  }
  return within_torques(torque);
}

/// The tool's inertia, bounded near singular postures.
Eigen::Matrix<double, 6, 6> ImpedanceController::inertia_of(const ToolJacobian& jacobian, const Matrix& mass) noexcept {
  // What a tool weighs at the most, in a direction in which the arm cannot move it.
  constexpr double kHeaviest_kg = 50;
  constexpr double kHeaviest_kg_m2 = 5;
  const ToolJacobian::PlainObject& j = jacobian;
  Matrix6 mobility = j * Eigen::LLT<Matrix>(mass).solve(
                             Eigen::Matrix<double, Eigen::Dynamic, 6, 0, control::kJointsMax, 6>(j.transpose()));
  report_.smallest_singular = smallest_singular_of(jacobian, turns());
  report_.singular = report_.smallest_singular < settings_.singular_from;
  if (report_.singular) {
    const double share = report_.smallest_singular / settings_.singular_from;
    Vector6 least;
    least << Eigen::Vector3d::Constant(1 / kHeaviest_kg), Eigen::Vector3d::Constant(1 / kHeaviest_kg_m2);
    mobility.diagonal() += (1 - share * share) * least;
  }
  if (!turns()) mobility.bottomRightCorner<3, 3>().diagonal().setConstant(1 / kHeaviest_kg_m2);
  return mobility.llt().solve(Matrix6::Identity());
}

/// Of spring and damper; the tool's pose and velocity are in the report.
Vector6 ImpedanceController::wrench_of(const Eigen::Matrix<double, 6, 6>& inertia, const ToolTarget& target) noexcept {
  Vector6 stiffness;
  stiffness << Eigen::Vector3d::Constant(settings_.stiffness_N_per_m),
      Eigen::Vector3d::Constant(settings_.stiffness_N_m_per_rad);
  const Eigen::Vector3d stretch = target.pose.position - report_.pose.position;
  const Eigen::Vector3d turn = turn_between(report_.pose.orientation, target.pose.orientation);
  Vector6 wrench;
  wrench << local_model::no_longer_than<Eigen::Vector3d>(settings_.stiffness_N_per_m * stretch, settings_.force_N_max),
      local_model::no_longer_than<Eigen::Vector3d>(settings_.stiffness_N_m_per_rad * turn, settings_.torque_N_m_max);
  Vector6 faster;
  faster << target.velocity, target.turn;
  faster -= report_.velocity;
  wrench += damping_of(inertia, stiffness, settings_.damping_ratio) * faster;
  wrench.head<3>() += target.push_N;
  const RobotLimits& limits = model_.limits();
  report_.too_fast = slow_down(wrench.head<3>(), report_.velocity.head<3>(), limits.tool_speed_m_per_s_max);
  if (turns()) {
    report_.too_fast |= slow_down(wrench.tail<3>(), report_.velocity.tail<3>(), limits.tool_turn_rad_per_s_max);
  }
  return wrench;
}

void ImpedanceController::push_from_limits(const Vector& q, const Vector& velocity, Vector& torque) noexcept {
  const RobotLimits& limits = model_.limits();
  for (Eigen::Index i = 0; i < q.rows(); ++i) {
    const double most = settings_.limit_torque_share * limits.torque_max[i];
    const auto push = [&](double left, double approach) {
      if (left >= settings_.limit_zone) return 0.0;
      report_.at_limit = true;
      const double spring = most * (1 - left / settings_.limit_zone);
      const double damper = most * std::max(0.0, approach) / limits.speed_max[i];
      return std::min(most, spring + damper);
    };
    torque[i] += push(q[i] - limits.lowest[i], -velocity[i]) - push(limits.highest[i] - q[i], velocity[i]);
  }
}

Vector ImpedanceController::within_torques(const Vector& torque) noexcept {
  if (!torque.allFinite()) return Vector::Zero(torque.rows());
  const double excess = torque.cwiseQuotient(model_.limits().torque_max).cwiseAbs().maxCoeff();
  report_.torque_share = excess > 1 ? 1 / excess : 1;
  return report_.torque_share * torque;
}

Vector ImpedanceController::stopping_torque(const device::Reading& reading) noexcept {
  constexpr double kStop_s = 0.05;
  report_ = {};
  if (!device::is_usable(reading, model_.joints())) {
    restart();
    return Vector::Zero(model_.joints());
  }
  const Vector velocity = velocity_.update(reading.latched, reading.joint);
  report_.pose = model_.pose(reading.joint);
  report_.velocity = model_.jacobian(reading.joint) * velocity;
  report_.joint_velocity = velocity;
  return within_torques(-(model_.mass_matrix(reading.joint) * velocity) / kStop_s);
}

}  // namespace forcebound::server
