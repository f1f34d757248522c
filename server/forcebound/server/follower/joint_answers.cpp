#include "forcebound/server/follower/joint_answers.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace forcebound::server {
namespace {

// A joint may have gone so far unseen, [rad] or [m]: from the first on its torque is drawn back, at the second it is.
constexpr double kFirst = 0.015;
constexpr double kMost = 0.03;
constexpr double kGone = 0.1;  // a share of the torque that counts as none
constexpr double kPatience_s = 0.2;
constexpr double kSoonest_s = 5e-3;
constexpr double kStiffest = 5e4;  // of all that a tool touches, at a joint [N m/rad], [N/m]
constexpr double kFriction = 4;    // of the bound, from one side to the other
constexpr double kFrictionOfLargest = 0.2;
constexpr double kSteps = 2;
constexpr double kStopsWith = 4;  // of the largest torque

double share_of(double way) noexcept {
  const double share = std::clamp((kMost - way) / (kMost - kFirst), 0.0, 1.0);
  return share < kGone ? 0 : share;
}

/// A torque takes its time to the motors, and a joint to a step of its encoder.
double far_share(double way, double given_s) noexcept {
  return given_s > 0 && given_s < kSoonest_s ? 1 : share_of(way);
}

}  // namespace

JointAnswers::JointAnswers(const Robot& robot) noexcept
    : robot_(robot), repeats_(robot.facts().encoder_step), contact_(Vector::Zero(robot.facts().joints())) {
  const control::DeviceFacts& facts = robot.facts();
  friction_ = (1 - facts.uncertainty.friction_share) * facts.friction;
  damping_ = (1 - facts.uncertainty.damping_share) * facts.damping.diagonal();
  far_ = (kFriction * facts.friction).cwiseMax(kFrictionOfLargest * robot.model().limits().torque_max);
  if (!robot.force_sensor()) far_ += kSteps * kStiffest * facts.encoder_step;
}

void JointAnswers::restart() noexcept {
  repeats_.restart();
  latched_.reset();
  joints_.fill({});
  frozen_ = false;
}

Vector JointAnswers::contact(const Vector& place) const noexcept {
  const auto sensed = robot_.sensed_force();
  if (!sensed) return Vector::Zero(place.rows());
  const ToolJacobian jacobian = robot_.model().jacobian(place);
  return jacobian.topRows<3>().transpose() * sensed->force_N +
         jacobian.bottomRows<3>().transpose() * sensed->torque_N_m;
}

void JointAnswers::note(const device::Reading& reading, const Vector& given) noexcept {
  const double elapsed_s = latched_ ? time::to_seconds(reading.latched - *latched_) : 0;
  if (latched_ && !(elapsed_s > 0)) return;
  latched_ = reading.latched;
  contact_ = contact(reading.joint);
  repeats_.note(reading.joint, elapsed_s > 0 ? elapsed_s : 1);
  frozen_ = false;
  for (Eigen::Index i = 0; i < reading.joint.rows(); ++i) {
    note(i, reading.joint, given[i] - contact_[i], given[i], elapsed_s);
  }
}

void JointAnswers::note(Eigen::Index i, const Vector& place, double net, double torque, double elapsed_s) noexcept {
  Joint& joint = joints_.at(static_cast<std::size_t>(i));
  const double still_s = repeats_.still_s(i);
  const double speed = std::abs(repeats_.velocity(i));
  if (still_s == 0) {
    joint = speed > 0 ? Joint{} : Joint{.net = net, .torque = torque};
    return;
  }
  // The tick on which it stops.
  if (speed > 0 && still_s == elapsed_s) joint.deceleration = deceleration_most(i, place);
  const double change = std::abs(net - joint.net);
  const double way = elapsed_s * std::max(0.0, change - friction_[i]) / damping_[i];
  joint.way += elapsed_s * speed;
  (joint.far ? joint.far_way : joint.way) += way;
  // What touches the tool is in it, if that is known.
  const double moving = robot_.force_sensor() ? std::min(change, std::abs(net)) : change;
  joint.far_s += moving > far_[i] ? elapsed_s : 0;
  const bool used_up = far_share(joint.far_way, joint.far_s) == 0 && joint.far_s > 0;
  const bool unanswered = used_up || joint.far_s > kPatience_s;
  const bool passed =
      joint.deceleration > 0 && speed * still_s > kFirst && repeats_.cannot_have_stopped(i, joint.deceleration);
  frozen_ = frozen_ || (still_s >= kSoonest_s && (unanswered || passed));
}

/// With the others free, it is as light as it can be.
double JointAnswers::deceleration_most(Eigen::Index joint, const Vector& place) const noexcept {
  const Eigen::LLT<Matrix> mass(robot_.model().mass_matrix(place));
  Vector unit = Vector::Zero(place.rows());
  unit[joint] = 1;
  const Vector mobility = mass.solve(unit);
  return kStopsWith * robot_.model().limits().torque_max[joint] * mobility[joint];
}

Vector JointAnswers::limited(const Vector& torque) noexcept {
  Vector limited = torque;
  for (Eigen::Index i = 0; i < torque.rows(); ++i) {
    if (repeats_.still_s(i) == 0) continue;
    Joint& joint = joints_.at(static_cast<std::size_t>(i));
    joint.far = std::abs(torque[i] - contact_[i] - joint.net) > far_[i];
    const double share = joint.far ? far_share(joint.far_way, joint.far_s) : share_of(joint.way);
    const double held = std::clamp(joint.torque, std::min(0.0, torque[i]), std::max(0.0, torque[i]));
    limited[i] = held + share * (torque[i] - held);
  }
  return limited;
}

}  // namespace forcebound::server
