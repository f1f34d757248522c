#include "forcebound/control/force_bounder.hpp"

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "forcebound/control/assertion.hpp"
#include "forcebound/control/classic_text.hpp"

namespace forcebound::control {
namespace {

// The square of less than this is no normal number any more, and with denormals flushed to zero another one.
constexpr double kForceLeast_N = 1e-150;

bool next_to_nothing(const Vector& force_N) noexcept { return force_N.lpNorm<Eigen::Infinity>() < kForceLeast_N; }

Vector rounded_toward_zero(Vector command, const Vector& step) noexcept {
  // A command that is a whole number of steps but for the rounding of its own arithmetic keeps its last step.
  constexpr double kWhole = 1 + 4 * std::numeric_limits<double>::epsilon();
  for (Eigen::Index i = 0; i < command.rows(); ++i) {
    if (step[i] > 0) command[i] = std::trunc(command[i] / step[i] * kWhole) * step[i];
  }
  return command;
}

}  // namespace

ForceBounder::ForceBounder(const DeviceFacts& facts, std::unique_ptr<PassivityLaw> law)
    : law_(std::move(law)),
      times_(facts),
      dof_(facts.degrees_of_freedom()),
      actuator_step_(facts.actuator_step),
      latency_s_least_(facts.latency_s),
      cartesian_(facts.cartesian),
      limits_(facts),
      reach_m_per_s_(facts.speed_max / (1 - facts.uncertainty.clock_share)),
      reading_error_((1 + 2 * facts.uncertainty.encoder_steps) * facts.encoder_step) {
  if (reach_m_per_s_.rows() > 0) {
    reading_error_ += (facts.uncertainty.stamp_s.most - facts.uncertainty.stamp_s.least) * reach_m_per_s_;
  }
  if (!law_) throw std::invalid_argument("a force bounder needs a law");
  if (actuator_step_.rows() != facts.joints()) {
    throw std::invalid_argument("device '" + facts.name + "': actuator step must have " +
                                std::to_string(facts.joints()) + " rows, got " + std::to_string(actuator_step_.rows()));
  }
  // No force at the tip gives each of more motors than it has axes a whole number of steps.
  if (facts.joints() != dof_ && !actuator_step_.isZero(0)) {
    throw std::invalid_argument("device '" + facts.name + "': actuator step must be 0 for " +
                                std::to_string(facts.joints()) + " joints and a tip of " + std::to_string(dof_) +
                                " degrees of freedom; give the motors' steps as a torque_ripple_share");
  }
  if (!(actuator_step_.array() >= 0).all()) {
    throw std::invalid_argument(
        joined("device '", facts.name, "': actuator step must be >= 0, got ", actuator_step_.transpose()));
  }
  if (!(facts.force_N_max >= 0)) {
    throw std::invalid_argument(
        joined("device '", facts.name, "': largest force must be >= 0 N, got ", facts.force_N_max));
  }
  if (!(facts.torque_N_m_max >= 0)) {
    throw std::invalid_argument(
        joined("device '", facts.name, "': largest torque must be >= 0 N m, got ", facts.torque_N_m_max));
  }
}

void ForceBounder::count(const Motion& motion) noexcept {
  counts_.intervals_impossible += !stamps_.stamp_believed();
  counts_.writes_failed += motion.write_failed;
  counts_.effects_outside_facts += times_.effect_is_outside_facts(motion);
  counts_.releases_outside_facts += times_.release_is_outside_facts(motion);
}

/// Of the two intervals at a wrong stamp, neither says how long the device moved.
void ForceBounder::pass(double interval_s) noexcept {
  stamps_.pass(interval_s);
  since_reached_s_ += stamps_.interval_believed() ? interval_s : std::numeric_limits<double>::infinity();
}

/// Whether the joints can have come there since the last reading that was used.
bool ForceBounder::within_reach(const Motion& motion) const noexcept {
  return ((motion.joint - reached_).cwiseAbs().array() <= (since_reached_s_ * reach_m_per_s_ + reading_error_).array())
      .all();
}

void ForceBounder::lose(const Motion& motion) noexcept {
  ++counts_.readings_too_far;
  if (reached_surely_) {
    law_->lose(motion);
    return;
  }
  Motion unknown = motion;
  unknown.interval_s = 0;
  law_->lose(unknown);
  reached_ = motion.joint;
  since_reached_s_ = 0;
}

/// False for a reading that is not finite or out of reach.
bool ForceBounder::credit(const Motion& motion) noexcept {
  pass(motion.interval_s);
  count(motion);
  if (!motion.position.allFinite() || !motion.joint.allFinite() || !motion.jacobian.allFinite()) {
    ++counts_.readings_not_finite;
    law_->lose(motion);
    return false;
  }
  if (reach_m_per_s_.rows() > 0) {
    const bool first = reached_.rows() == 0 || std::isinf(since_reached_s_);
    if (!first && !within_reach(motion)) {
      lose(motion);
      return false;
    }
    reached_ = motion.joint;
    since_reached_s_ = 0;
    reached_surely_ = !first;
  }
  law_->credit(motion);
  return true;
}

Vector ForceBounder::release(const Motion& motion) noexcept {
  const Vector zero = Vector::Zero(dof_);
  // The law is asked although its answer is not used: it may have a tool of its own to move.
  if (credit(motion)) (void)law_->bound(zero);
  law_->commit(zero);
  return zero;
}

Vector ForceBounder::tick(const Motion& motion, const Vector& request_N) noexcept {
  Vector force = Vector::Zero(dof_);
  if (credit(motion)) force = rounded(sound(law_->bound(saturated(request_N))), motion);
  if (next_to_nothing(force)) force.setZero();
  FORCEBOUND_ASSERT(force.rows() == dof_ && force.allFinite(),
                    "a force that is committed is finite, with a row for each degree of freedom");
  law_->commit(force);
  return force;
}

Vector ForceBounder::confirmed(const Vector& force_N, double latency_s) noexcept {
  if (force_N.isZero(0)) return force_N;
  if (latency_s >= latency_s_least_ && law_->allows(force_N, latency_s)) return force_N;
  ++counts_.withdrawn;
  const Vector zero = Vector::Zero(force_N.rows());
  law_->commit(zero);
  return zero;
}

Vector ForceBounder::saturated(const Vector& request_N) noexcept {
  if (request_N.rows() != dof_ || !request_N.allFinite()) {
    ++counts_.requests_not_finite;
    return Vector::Zero(dof_);
  }
  const double largest = request_N.lpNorm<Eigen::Infinity>();
  if (next_to_nothing(request_N)) return Vector::Zero(dof_);
  // The length of 1e308 N on every axis is beyond a double, its direction is not.
  const double most = limits_.longest_along(request_N / largest);
  if (largest <= most) return request_N;
  ++counts_.saturated;
  return (request_N / largest) * most;
}

/// Guards against a faulty law: a force that is not finite or of the wrong size becomes zero; one longer than the
/// device may be asked for is shortened.
Vector ForceBounder::sound(const Vector& force_N) noexcept {
  if (force_N.rows() != dof_ || !force_N.allFinite()) {
    ++counts_.forces_not_finite;
    return Vector::Zero(dof_);
  }
  constexpr double kRounding = 1 + 1e-12;
  const double most = limits_.longest_along(force_N);
  return 1 > most * kRounding ? Vector(force_N * most) : force_N;
}

Vector ForceBounder::rounded(const Vector& force_N, const Motion& motion) const noexcept {
  if (actuator_step_.isZero(0)) return force_N;
  const Matrix& jacobian = motion.jacobian;
  Vector force = cartesian_ ? rounded_toward_zero(force_N, actuator_step_)
                            : Vector(jacobian.transpose().partialPivLu().solve(
                                  rounded_toward_zero(jacobian.transpose() * force_N, actuator_step_)));
  // Near a singular configuration a small torque can be a huge force at the tip.
  const bool longer = !(limits_.longest_along(force) >= 1);
  if (!force.allFinite() || longer || !law_->allows(force, motion.latency_s_max)) force.setZero();
  return force;
}

}  // namespace forcebound::control
