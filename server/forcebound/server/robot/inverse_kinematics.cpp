#include "forcebound/server/robot/inverse_kinematics.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

namespace forcebound::server {
namespace {

Vector6 error_of(const ToolPose& here, const ToolPose& there) noexcept {
  Vector6 error;
  error << there.position - here.position, turn_between(here.orientation, there.orientation);
  return error;
}

Posture posture_from(const RobotModel& model, const ToolPose& pose, Vector joints) {
  constexpr int kStepsMost = 200;
  constexpr double kTurnMost = 0.3;
  constexpr double kDamping = 1e-6;
  for (int i = 0; i < kStepsMost; ++i) {
    const Vector6 error = error_of(model.pose(joints), pose);
    if (error.norm() < 1e-12) break;
    const ToolJacobian jacobian = model.jacobian(joints);
    Eigen::Matrix<double, 6, 6> square = jacobian * jacobian.transpose();
    square.diagonal().array() += kDamping * (1 + 1e3 * error.squaredNorm());
    Vector step = jacobian.transpose() * square.llt().solve(error);
    const double longest = step.cwiseAbs().maxCoeff();
    if (longest > kTurnMost) step *= kTurnMost / longest;
    joints = (joints + step).cwiseMax(model.limits().lowest).cwiseMin(model.limits().highest);
  }
  const Vector6 error = error_of(model.pose(joints), pose);
  return {.joints = joints, .off_m = error.head<3>().norm(), .off_rad = error.tail<3>().norm()};
}

}  // namespace

Eigen::Vector3d turn_between(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) noexcept {
  const Eigen::Quaterniond turn = to * from.conjugate();
  const double side = turn.w() < 0 ? -1 : 1;
  const double half_sine = turn.vec().norm();
  constexpr double kSmall = 1e-9;
  const double angle = 2 * std::atan2(half_sine, side * turn.w());
  return side * (half_sine < kSmall ? 2 : angle / half_sine) * turn.vec();
}

Posture posture_for(const RobotModel& model, const ToolPose& pose) {
  constexpr int kTries = 20;
  constexpr double kAway = 0.5;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> away(-kAway, kAway);
  Posture best = posture_from(model, pose, model.rest());
  for (int i = 1; i < kTries && !best.reaches(); ++i) {
    Vector start = model.rest();
    for (double& joint : start) joint += away(random);
    const Posture other = posture_from(model, pose, start);
    if (other.off_m + other.off_rad < best.off_m + best.off_rad) best = other;
  }
  return best;
}

}  // namespace forcebound::server
