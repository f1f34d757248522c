#include "forcebound/client/session/unseen_energy.hpp"

#include <algorithm>
#include <cmath>

namespace forcebound::client {
namespace {

constexpr double kLeaves_m_per_s2 = 5;
constexpr double kStops_m_per_s2 = 200;
constexpr double kHandle_m = 0.1;  // of a turn, which has a way only off the tip
constexpr double kFirst = 0.3;     // of the most energy: from there on the force fades,
constexpr double kLast = 0.8;      // and has ended there
constexpr double kGone = 0.1;      // a share that counts as none
constexpr double kBack_s = 0.05;
constexpr double kPatience_s = 0.2;
constexpr double kOfLargest = 0.25;  // of the device's force
constexpr double kFriction = 4;      // of its bound
constexpr double kStiffest_N_per_m = 5000;
constexpr double kSteps = 2;
constexpr double kNoReach_m = 1e-6;  // a joint that moves nothing

/// How far the tip goes for a joint's way.
double reach_of(const control::Matrix& jacobian, Eigen::Index joint) noexcept {
  constexpr Eigen::Index kTranslations = 3;
  const auto column = jacobian.col(joint);
  const Eigen::Index translations = std::min(kTranslations, column.rows());
  const double turn = column.tail(column.rows() - translations).norm();
  return std::hypot(column.head(translations).norm(), kHandle_m * turn);
}

}  // namespace

UnseenEnergy::UnseenEnergy(const control::DeviceFacts& facts, const device::Safety& limits) noexcept
    : bounds_(limits != device::Safety{}),
      force_N_max_(facts.force_N_max),
      friction_((1 - facts.uncertainty.friction_share) * facts.friction),
      step_(facts.encoder_step),
      repeats_(facts.encoder_step) {}

void UnseenEnergy::add(const device::Reading& reading, const Vector& applied, double elapsed_s) noexcept {
  if (!bounds_ || !(elapsed_s > 0)) return;
  repeats_.add(reading.joint, elapsed_s);
  const Vector torque = reading.jacobian.transpose() * applied;
  double energy_J = 0;
  frozen_ = false;
  for (Eigen::Index i = 0; i < torque.rows(); ++i) {
    const double reach_m = reach_of(reading.jacobian, i);
    add(i, torque[i], reach_m, elapsed_s);
    energy_J += joints_.at(static_cast<std::size_t>(i)).energy_J;
    frozen_ = frozen_ || is_frozen(i, reach_m);
  }
  const double left = std::clamp((kLast - energy_J / kMost_J) / (kLast - kFirst), 0.0, 1.0);
  share_ = std::min(left < kGone ? 0 : left, share_ + elapsed_s / kBack_s);
}

void UnseenEnergy::add(Eigen::Index i, double torque, double reach_m, double elapsed_s) noexcept {
  Joint& joint = joints_.at(static_cast<std::size_t>(i));
  const double still_s = repeats_.still_s(i);
  if (still_s == 0 || reach_m < kNoReach_m) {
    joint = {};
    return;
  }
  const double friction = i < friction_.rows() ? friction_[i] : 0;
  const double push = std::max(0.0, std::abs(torque) - friction);
  const double along = torque < 0 ? -repeats_.velocity(i) : repeats_.velocity(i);
  const double speed = std::max(0.0, along + kLeaves_m_per_s2 / reach_m * still_s);
  joint.energy_J += push * speed * elapsed_s;
  joint.most_N = std::max(joint.most_N, push / reach_m);
}

bool UnseenEnergy::is_frozen(Eigen::Index i, double reach_m) const noexcept {
  const Joint& joint = joints_.at(static_cast<std::size_t>(i));
  if (repeats_.still_s(i) < kPatience_s || joint.energy_J < kFirst * kMost_J) return false;
  const double friction_N = (i < friction_.rows() ? kFriction * friction_[i] : 0) / reach_m;
  const double step_m = (i < step_.rows() ? step_[i] : 0) * reach_m;
  const double hidden_N = std::max(kOfLargest * force_N_max_, friction_N) + kSteps * kStiffest_N_per_m * step_m;
  const bool unanswered = share_ == 0 && joint.most_N > hidden_N;
  return unanswered || repeats_.cannot_have_stopped(i, kStops_m_per_s2 / reach_m);
}

}  // namespace forcebound::client
