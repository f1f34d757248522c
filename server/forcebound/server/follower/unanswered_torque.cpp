#include "forcebound/server/follower/unanswered_torque.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace forcebound::server {
namespace {

constexpr double kWay = 0.01;        // [rad] or [m]
constexpr double kWaySteps = 10;     // of the encoder
constexpr double kStiffest = 5e4;    // of all that a tool touches, at a joint [N m/rad] or [N/m]
constexpr double kFriction = 4;      // of the bound, from one side to the other
constexpr double kOfLargest = 0.2;   // likewise of the largest torque
constexpr double kContactSteps = 2;  // that a contact gives way unseen
constexpr double kDampingMost = 2;   // of the bound
constexpr double kSensed_s = 0.01;   // ago, at most

}  // namespace

UnansweredTorque::UnansweredTorque(const Robot& robot) noexcept : robot_(robot), repeats_(robot.facts().encoder_step) {
  const control::DeviceFacts& facts = robot.facts();
  const Vector step = facts.encoder_step.rows() > 0 ? facts.encoder_step : Vector::Zero(facts.joints());
  least_ = (kFriction * facts.friction).cwiseMax(kOfLargest * robot.model().limits().torque_max);
  if (!robot.force_sensor()) least_ += kContactSteps * kStiffest * step;
  damping_ = kDampingMost * facts.damping.diagonal();
  way_ = (kWaySteps * step).cwiseMax(kWay);
}

void UnansweredTorque::restart() noexcept {
  latched_.reset();
  repeats_.restart();
  frozen_ = false;
}

void UnansweredTorque::update(const device::Reading& reading, const Vector& given,
                              const std::optional<Vector6>& sensed) noexcept {
  const double elapsed_s = latched_ ? time::to_seconds(reading.latched - *latched_) : 0;
  if (latched_ && !(elapsed_s > 0)) return;
  latched_ = reading.latched;
  Vector net = given;
  if (sensed) net -= robot_.model().jacobian(reading.joint).transpose() * *sensed;
  repeats_.add(reading.joint, elapsed_s);
  if (still_s() == 0) {
    lowest_ = net;
    highest_ = net;
    joints_.fill({});
    frozen_ = false;
  } else if (sensed && still_s() <= kSensed_s) {
    lowest_ = lowest_.cwiseMin(net);
    highest_ = highest_.cwiseMax(net);
  } else {
    drive(reading.joint, net, elapsed_s);
  }
}

/// For how long the readings of all joints have been the same.
double UnansweredTorque::still_s() const noexcept {
  double still_s = repeats_.still_s(0);
  for (Eigen::Index i = 1; i < least_.rows(); ++i) still_s = std::min(still_s, repeats_.still_s(i));
  return still_s;
}

void UnansweredTorque::drive(const Vector& place, const Vector& net, double elapsed_s) noexcept {
  const Vector change = net - net.cwiseMax(lowest_).cwiseMin(highest_);
  if (((change.cwiseAbs() - least_).array() <= 0).all()) return;
  const Matrix mass = robot_.model().mass_matrix(place);
  for (Eigen::Index i = 0; i < change.rows(); ++i) {
    Joint& joint = joints_.at(static_cast<std::size_t>(i));
    const double must = std::copysign(std::max(0.0, std::abs(change[i]) - least_[i]), change[i]);
    joint.speed = (mass(i, i) * joint.speed + elapsed_s * must) / (mass(i, i) + elapsed_s * damping_[i]);
    joint.way += elapsed_s * joint.speed;
    frozen_ = frozen_ || std::abs(joint.way) > way_[i];
  }
}

}  // namespace forcebound::server
