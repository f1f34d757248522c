#include "forcebound/control/exact_law.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "forcebound/control/assertion.hpp"
#include "forcebound/control/classic_text.hpp"
#include "forcebound/control/damping.hpp"

namespace forcebound::control {
namespace {

constexpr double kLatencyMaxPeriods = 8;

template <typename Value>
[[noreturn]] void refuse(const DeviceFacts& facts, const char* what, const Value& got) {
  throw std::invalid_argument(joined("device '", facts.name, "': ", what, ", got ", got));
}

void check(const Uncertainty& uncertainty, const DeviceFacts& facts) {
  const auto bracket = [&](const char* what, const Bracket& b) {
    if (std::isfinite(b.least) && std::isfinite(b.most) && b.least <= b.most) return;
    refuse(facts, what, joined(b.least, " to ", b.most));
  };
  const auto share = [&](const char* what, double value) {
    if (!(value >= 0) || value >= 1) refuse(facts, what, value);
  };
  bracket("uncertainty of stamps must be two times [s], least first", uncertainty.stamp_s);
  bracket("uncertainty of the latency must be two times [s], least first", uncertainty.latency_s);
  bracket("uncertainty of the hold time must be two times [s], least first", uncertainty.hold_s);
  share("uncertainty of the clock must be a share of 0 to less than 1", uncertainty.clock_share);
  share("uncertainty of the damping must be a share of 0 to less than 1", uncertainty.damping_share);
  share("uncertainty of the friction must be a share of 0 to less than 1", uncertainty.friction_share);
  share("ripple of the torque must be a share of 0 to less than 1", uncertainty.torque_ripple_share);
  bracket("offset of the latency must be two times [s], least first", uncertainty.latency_offset_s);
  if (facts.latency_s + uncertainty.latency_s.least + uncertainty.latency_offset_s.least < 0) {
    refuse(facts, "latency must be >= 0 s at its least offset, or a force would take effect before its command",
           facts.latency_s + uncertainty.latency_s.least + uncertainty.latency_offset_s.least);
  }
  bracket("uncertainty of the motors' gain must be two shares, least first", uncertainty.torque_gain_share);
  if (!(uncertainty.torque_gain_share.least > -1)) {
    refuse(facts, "uncertainty of the motors' gain must be more than -1, or it could be zero",
           uncertainty.torque_gain_share.least);
  }
  const auto not_negative = [&](const char* what, double value) {
    if (!(value >= 0) || !std::isfinite(value)) refuse(facts, what, value);
  };
  not_negative("uncertainty of the encoder must be >= 0 steps", uncertainty.encoder_steps);
  not_negative("lag of the actuator must be >= 0 s", uncertainty.actuator_lag_s);
  if (facts.latency_s + uncertainty.latency_s.least < 0) {
    refuse(facts, "latency must be >= 0 s at the least, or a force would take effect before its command",
           facts.latency_s + uncertainty.latency_s.least);
  }
  if (!(facts.hold_s_max + uncertainty.hold_s.least > 0)) {
    refuse(facts, "hold time must be > 0 s at the least", facts.hold_s_max + uncertainty.hold_s.least);
  }
}

void check(const DeviceFacts& facts) {
  (void)Damping::from_matrix(facts.damping);
  const auto per_joint = [&](const Vector& v) {
    return v.rows() == facts.damping.rows() && v.allFinite() && (v.array() >= 0).all();
  };
  const auto above_zero = [](double v) { return v > 0 && std::isfinite(v); };
  if (!above_zero(facts.period_s)) refuse(facts, "period must be > 0 s", facts.period_s);
  if (!above_zero(facts.hold_s_max)) refuse(facts, "hold time must be > 0 s", facts.hold_s_max);
  if (!(facts.release_share >= 0) || facts.release_share > 1) {
    refuse(facts, "share of a force at its release must be 0 to 1", facts.release_share);
  }
  if (!(facts.release_s >= 0) || !std::isfinite(facts.release_s)) {
    refuse(facts, "time of release must be >= 0 s", facts.release_s);
  }
  if (!facts.releases && facts.release_share > 0 && facts.release_s > 0) {
    refuse(facts, "share of a force at its release must be 0 where the device does not release", facts.release_share);
  }
  if (!(facts.latency_s >= 0) || facts.latency_s > kLatencyMaxPeriods * facts.period_s) {
    refuse(facts, "latency must be 0 to 8 periods [s]", facts.latency_s);
  }
  if (!(facts.force_N_max >= 0)) refuse(facts, "largest force must be >= 0 N", facts.force_N_max);
  if (!(facts.torque_N_m_max >= 0)) refuse(facts, "largest torque must be >= 0 N m", facts.torque_N_m_max);
  if (!per_joint(facts.friction)) refuse(facts, "friction must be >= 0 for each joint", facts.friction.transpose());
  if (!per_joint(facts.encoder_step)) {
    refuse(facts, "encoder step must be >= 0 for each joint", facts.encoder_step.transpose());
  }
  check(facts.uncertainty, facts);
}

}  // namespace

ExactLaw::ExactLaw(const DeviceFacts& facts, EnergyMemory memory, const Spending& spending)
    : dof_((check(facts), facts.degrees_of_freedom())),
      force_N_max_(facts.force_N_max),
      torque_N_m_max_(facts.torque_N_m_max),
      rotations_(facts.rotations),
      memory_(memory),
      spending_(spending),
      ledger_(facts),
      jacobian_(Matrix::Identity(dof_, facts.joints())) {}

void ExactLaw::credit(const Motion& motion) noexcept {
  FORCEBOUND_ASSERT(motion.joint.rows() == jacobian_.cols(), "a reading has a row for each joint");
  lose(motion);
  jacobian_ = motion.jacobian;
  ledger_.read(motion.joint);
  if (memory_ == EnergyMemory::capped && ledger_.located()) forget_excess();
}

void ExactLaw::lose(const Motion& motion) noexcept {
  latency_s_max_ = std::max(0.0, motion.latency_s_max);
  interval_s_ = motion.interval_s;
  ledger_.pass(motion);
}

double ExactLaw::energy_J() const noexcept { return ledger_.at_effect(latency_s_max_).energy_J; }

void ExactLaw::forget_excess() noexcept {
  constexpr double kRoom = 1 + 1e-12;  // rounding shall not bound the largest force
  Vector largest = force_N_max_ * jacobian_.topRows(dof_ - rotations_).colwise().norm().transpose();
  if (rotations_ > 0) largest += torque_N_m_max_ * jacobian_.bottomRows(rotations_).colwise().norm().transpose();
  const double kept_J = std::min(kRoom * spending_.memory_reserves * ledger_.needed_J(largest), spending_.memory_J_max);
  // If the write of the next force fails, those told so far go on until their release.
  const double excess_J = energy_J() - std::max(kept_J, ledger_.needed_J(ledger_.largest_held()));
  if (!(excess_J > 0)) return;
  ledger_.add_J(-excess_J);
  given_.add(excess_J);
}

void ExactLaw::receive_energy(double energy_J) noexcept {
  FORCEBOUND_ASSERT(energy_J >= 0, "energy received is a number and not negative");
  ledger_.add_J(energy_J);
}

Vector ExactLaw::bound(const Vector& request_N) noexcept {
  const double largest = request_N.lpNorm<Eigen::Infinity>();
  if (!(largest > 0) || !ledger_.located()) {
    shown_share_ = 1;
    return Vector::Zero(dof_);
  }
  // Through its largest component, so that neither 1e300 N nor 1e-300 N leaves the range of a double when squared.
  const Vector direction = request_N / largest;
  const auto left = ExactLedger::spendable(ledger_.at_effect(latency_s_max_));
  double scale = left ? std::min(largest, ledger_.largest_scale(jacobian_.transpose() * direction, *left)) : 0.0;
  if (memory_ == EnergyMemory::capped) {
    const double share = std::min(scale / largest, shown_share_ + spending_.rise_per_s * std::max(0.0, interval_s_));
    if (share < scale / largest) scale = share * largest;
    shown_share_ = share;
  }
  return scale == largest ? request_N : Vector(direction * scale);
}

bool ExactLaw::allows(const Vector& force_N, double latency_s) const noexcept {
  constexpr double kForceRounding = 1e-12;
  if (force_N.isZero(0)) return true;
  if (!ledger_.located()) return false;
  const Vector torque = jacobian_.transpose() * force_N * (1 - kForceRounding);
  const auto left = ExactLedger::spendable(ledger_.at_effect(latency_s));
  return left && ledger_.needed_J(torque, left->more_at_most) <= left->energy_J;
}

void ExactLaw::commit(const Vector& force_N) noexcept { ledger_.commit(jacobian_.transpose() * force_N); }

}  // namespace forcebound::control
