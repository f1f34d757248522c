#include "tests/tools/lab/soak/ledger_in_long_double.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "forcebound/control/exact_law.hpp"
#include "forcebound/control/translation.hpp"
#include "forcebound/control/wrench.hpp"

namespace forcebound::lab {
namespace {

using control::Matrix;
using control::Vector;
using test::ForcePiece;
using time::Nanoseconds;
using Real = long double;

/// The time by which the session expects a force being chosen to be commanded.
constexpr Nanoseconds kChoosing = std::chrono::microseconds(20);
constexpr Real kShortestPeriods = 0.1L;

Real seconds(Nanoseconds t) { return static_cast<Real>(t.count()) * 1e-9L; }

}  // namespace

std::unique_ptr<LedgerInLongDouble> LedgerInLongDouble::make(const sim::ClosedLoop::Settings& settings) {
  const control::DeviceFacts& facts = settings.device.facts;
  // With bounds in the place of facts there is another worst case, which the hard cases recompute.
  if (settings.flaws != device::DeviceFlaws{} || facts.uncertainty != control::Uncertainty{}) return nullptr;
  if (facts.release_share > 0) return nullptr;
  const bool exact = settings.law == "fba-exact" && facts.encoder_step.isZero(0) && facts.damping.isDiagonal(0) &&
                     settings.timing.choosing_max == Nanoseconds::zero();
  const bool published = (settings.law == "fba-less" || settings.law == "none") && facts.cartesian;
  if (!exact && !published) return nullptr;
  return std::unique_ptr<LedgerInLongDouble>(new LedgerInLongDouble(settings));
}

LedgerInLongDouble::LedgerInLongDouble(const sim::ClosedLoop::Settings& settings)
    : device_(settings.device),
      kinematics_(device::make_kinematics(settings.device.geometry)),
      exact_(settings.law == "fba-exact"),
      capped_(settings.law_options.memory == control::EnergyMemory::capped),
      latency_(time::from_seconds(device_.facts.latency_s)),
      hold_(time::from_seconds(device_.facts.hold_s_max)) {}

Real LedgerInLongDouble::energy_J(const record::TickRecord& tick) {
  if (before_) exact_ ? credit_exactly(tick) : credit_as_published(tick);
  Real available_J = energy_J_;
  if (exact_) {
    const Real taken_J = taken_until_next_J(tick);
    if (capped_) energy_J_ = std::min(energy_J_, most_J(tick.joint) + taken_J);
    available_J = energy_J_ - taken_J;
  }
  const Nanoseconds earliest = commands_.empty() ? Nanoseconds::min() : commands_.back().effect;
  const Vector wrench =
      control::wrench_of(tick.applied, control::translation_of(tick.applied_torque_N_m), device_.facts.rotations);
  commands_.push_back(
      {std::max(earliest, tick.time + tick.latency + latency_), jacobian(tick.joint).transpose() * wrench});
  before_ = tick;
  return available_J;
}

Matrix LedgerInLongDouble::jacobian(const Vector& joint) const { return kinematics_->jacobian(joint); }

/// The forces in effect from one time to another, zero where the device has released them.
LedgerInLongDouble::Pieces LedgerInLongDouble::pieces(Nanoseconds begin, Nanoseconds end) const {
  Pieces result(static_cast<std::size_t>(device_.facts.damping.rows()));
  const auto add = [&](const Command* command, Nanoseconds from, Nanoseconds to) {
    if (to <= from) return;
    for (std::size_t i = 0; i < result.size(); ++i) {
      const double torque = command != nullptr ? command->torque[static_cast<Eigen::Index>(i)] : 0.0;
      result[i].push_back({torque, static_cast<double>(seconds(to - from))});
    }
  };
  Nanoseconds now = begin;
  for (std::size_t k = 0; k < commands_.size(); ++k) {
    const Nanoseconds from = std::clamp(commands_[k].effect, now, end);
    const Nanoseconds to = k + 1 < commands_.size() ? std::clamp(commands_[k + 1].effect, from, end) : end;
    const Nanoseconds release = std::clamp(commands_[k].effect + hold_, from, to);
    add(nullptr, now, from);
    add(&commands_[k], from, release);
    add(nullptr, release, to);
    now = to;
  }
  add(nullptr, now, end);
  return result;
}

Real LedgerInLongDouble::reserve_J(std::size_t joint, Real torque, Real duration_s) const {
  const auto i = static_cast<Eigen::Index>(joint);
  const Real excess = std::max(std::fabs(torque) - device_.facts.friction[i], Real{0});
  return excess * excess * duration_s / (4 * Real{device_.facts.damping(i, i)});
}

void LedgerInLongDouble::credit_exactly(const record::TickRecord& tick) {
  Pieces since = pieces(before_->time, tick.time);
  const Real stretch =
      std::max(Real{1}, kShortestPeriods * device_.facts.period_s / seconds(tick.time - before_->time));
  for (std::size_t i = 0; i < since.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    for (ForcePiece& piece : since[i]) piece.duration_s *= static_cast<double>(stretch);
    energy_J_ += least_cost_J({device_.facts.damping(row, row), device_.facts.friction[row]}, since[i],
                              Real{tick.joint[row]} - before_->joint[row]);
  }
  while (commands_.size() > 1 && commands_[1].effect <= tick.time) commands_.pop_front();
}

/// The joints are the task's axes here: an arm's damping changes, and the record does not contain it.
void LedgerInLongDouble::credit_as_published(const record::TickRecord& tick) {
  const Vector& force = before_->applied;
  const Matrix& damping = device_.facts.damping;
  const Nanoseconds interval = tick.time - before_->time;
  const bool released = commands_.back().effect + hold_ <= tick.time && hold_ < interval;
  const Real period_s = device_.facts.period_s;
  if (released) {
    const Vector reach = damping.ldlt().solve(force);
    Real square = 0;
    for (Eigen::Index i = 0; i < force.rows(); ++i) square += Real{force[i]} * reach[i];
    energy_J_ -= square * std::max(seconds(hold_), period_s) / 4;
  } else {
    for (Eigen::Index i = 0; i < force.rows(); ++i) {
      const Real d = Real{tick.position[i]} - before_->position[i];
      energy_J_ -= Real{force[i]} * d;
      for (Eigen::Index j = 0; j < force.rows(); ++j) {
        energy_J_ += d * damping(i, j) / period_s * (Real{tick.position[j]} - before_->position[j]);
      }
    }
  }
}

/// By the forces already commanded, until the one now to be chosen is in effect.
Real LedgerInLongDouble::taken_until_next_J(const record::TickRecord& tick) const {
  Nanoseconds end = tick.time + latency_ + kChoosing;
  if (!commands_.empty()) end = std::max(end, commands_.back().effect);
  const Pieces coming = pieces(tick.time, end);
  Real taken_J = 0;
  for (std::size_t i = 0; i < coming.size(); ++i) {
    for (const ForcePiece& piece : coming[i]) taken_J += reserve_J(i, piece.force_N, piece.duration_s);
  }
  return taken_J;
}

Real LedgerInLongDouble::most_J(const Vector& joint) const {
  const control::DeviceFacts& facts = device_.facts;
  const Matrix j = jacobian(joint);
  Real most_J = 0;
  for (Eigen::Index i = 0; i < joint.rows(); ++i) {
    const Real torque = Real{facts.force_N_max} * j.col(i).head(facts.translations()).norm() +
                        Real{facts.torque_N_m_max} * j.col(i).tail(facts.rotations).norm();
    most_J += reserve_J(static_cast<std::size_t>(i), torque, seconds(hold_));
  }
  return Real{control::Spending().memory_reserves} * most_J;
}

}  // namespace forcebound::lab
