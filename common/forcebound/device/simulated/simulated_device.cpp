#include "forcebound/device/simulated/simulated_device.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace forcebound::device {
namespace {

constexpr Nanoseconds kCell = std::chrono::milliseconds(1);
constexpr double kRateMax = 1e5;  // 1/s

std::unique_ptr<const Kinematics> make_kinematics(const DeviceDescription& description) {
  if (description.arm) return std::make_unique<ArmKinematics>(*description.arm);
  return std::make_unique<CartesianKinematics>();
}

std::unique_ptr<const Operator> checked(std::unique_ptr<const Operator> hand, const control::DeviceFacts& facts) {
  if (hand->degrees_of_freedom() == facts.degrees_of_freedom()) return hand;
  std::ostringstream text;
  text << "operator '" << hand->name() << "' moves " << hand->degrees_of_freedom() << " degrees of freedom, device '"
       << facts.name << "' has " << facts.degrees_of_freedom();
  throw std::invalid_argument(text.str());
}

}  // namespace

SimulatedDevice::SimulatedDevice(DeviceDescription description, std::unique_ptr<const Operator> hand)
    : description_(std::move(description)),
      operator_(checked(std::move(hand), description_.facts)),
      kinematics_(make_kinematics(description_)),
      motion_(description_.facts.damping, description_.facts.friction,
              kinematics_->joints_at(operator_->target(0).position)),
      tip_damping_(control::Damping::from_matrix(description_.facts.damping)),
      torque_(Vector::Zero(motion_.position().size())) {
  reading_jacobian_ = kinematics_->jacobian(motion_.position());
  linearise();
  const double rate = motion_.fastest_rate();
  if (rate <= kRateMax) return;
  std::ostringstream text;
  text << "device '" << facts().name << "' with operator '" << operator_->name() << "' has a time constant of "
       << 1 / rate << " s; it must be >= " << 1 / kRateMax << " s: more mass, or less damping or stiffness";
  throw std::invalid_argument(text.str());
}

Reading SimulatedDevice::read(Nanoseconds now) noexcept {
  advance_to(now);
  Reading reading;
  reading.joint = motion_.position();
  for (Eigen::Index i = 0; i < reading.joint.size(); ++i) {
    const double step = facts().encoder_step[i];
    if (step > 0) reading.joint[i] = step * std::round(reading.joint[i] / step);
  }
  reading.position = kinematics_->position(reading.joint);
  if (description_.arm) {
    reading_jacobian_ = kinematics_->jacobian(reading.joint);
    tip_damping_ = control::Damping::from_joints(reading_jacobian_, facts().damping);
  }
  reading.jacobian = reading_jacobian_;
  reading.damping = &tip_damping_;
  reading.latched = now;
  return reading;
}

void SimulatedDevice::apply(Nanoseconds now, const Vector& force_N) noexcept {
  advance_to(now);
  const bool sound = force_N.size() == torque_.size() && force_N.allFinite();
  counters_.faulty_commands += !sound;
  // If the queue is full, the command replaces the newest one in it.
  pending_count_ = std::min(pending_count_ + 1, kPendingMax);
  Command& command = pending_[static_cast<std::size_t>(pending_count_ - 1)];
  command.effect = time_ + time::from_seconds(facts().latency_s);
  command.torque.setZero(torque_.size());
  if (sound) command.torque.noalias() = reading_jacobian_.transpose() * force_N;
  if (!command.torque.allFinite()) command.torque.setZero();
  released_at_.reset();
  change_torque();
}

SimulatedDevice::Truth SimulatedDevice::truth() const noexcept {
  const Vector& joint = motion_.position();
  return {joint, motion_.velocity(), kinematics_->position(joint), kinematics_->jacobian(joint) * motion_.velocity()};
}

DeviceCounters SimulatedDevice::counters() const noexcept {
  DeviceCounters counters = counters_;
  counters.frozen_joints = motion_.frozen_joints();
  return counters;
}

void SimulatedDevice::advance_to(Nanoseconds now) noexcept {
  if (!origin_) origin_ = now;
  Nanoseconds end = now - *origin_;
  const Nanoseconds excess = end - time_ - kGapMax;
  if (excess > Nanoseconds{0}) end -= excess;
  while (time_ < end) {
    const std::int64_t cell = time_ / kCell;
    if (cell != cell_) enter_cell(cell);
    Nanoseconds next = std::min(end, (cell + 1) * kCell);
    if (pending_count_ > 0) next = std::min(next, pending_[0].effect);
    if (release_) next = std::min(next, *release_);
    integrate(next - time_);
    time_ = next;
    change_torque();
  }
  if (excess > Nanoseconds{0}) {
    *origin_ += excess;
    ++counters_.gaps_cut;
  }
}

void SimulatedDevice::change_torque() noexcept {
  if (release_ && *release_ <= time_) {
    torque_.setZero();
    if (pending_count_ == 0) released_at_ = *origin_ + *release_;
    release_.reset();
  }
  while (pending_count_ > 0 && pending_[0].effect <= time_) {
    torque_ = pending_[0].torque;
    if (facts().releases) release_ = pending_[0].effect + time::from_seconds(facts().hold_s_max);
    std::move(pending_.begin() + 1, pending_.begin() + pending_count_, pending_.begin());
    --pending_count_;
  }
}

void SimulatedDevice::enter_cell(std::int64_t cell) noexcept {
  const auto target_at = [this](std::int64_t knot) { return operator_->target(time::to_seconds(knot * kCell)); };
  cell_start_ = cell == cell_ + 1 && cell > 0 ? cell_end_ : target_at(cell);
  cell_end_ = target_at(cell + 1);
  cell_ = cell;
  if (cell_start_.grip == grip_) return;
  grip_ = cell_start_.grip;
  linearise();
}

void SimulatedDevice::linearise() noexcept {
  const Hand& hand = operator_->hand();
  jacobian_ = kinematics_->jacobian(motion_.position());
  const Matrix metric = jacobian_.transpose() * jacobian_;
  motion_.set_system({.inertia = description_.inertia + hand.mass_kg * metric,
                      .damping = facts().damping + grip_ * hand.damping_N_s_per_m * metric,
                      .stiffness = grip_ * hand.stiffness_N_per_m * metric});
}

void SimulatedDevice::integrate(Nanoseconds length) noexcept {
  if (description_.arm) linearise();
  tip_ = kinematics_->position(motion_.position());

  const double cell_s = time::to_seconds(kCell);
  const Vector slope = (cell_end_.position - cell_start_.position) / cell_s;
  const Vector square = (3 * slope - 2 * cell_start_.velocity - cell_end_.velocity) / cell_s;
  const Vector cube = (cell_start_.velocity + cell_end_.velocity - 2 * slope) / (cell_s * cell_s);

  // The cubic about this piece's beginning, e into the cell, relative to the tip there.
  const double e = time::to_seconds(time_ - cell_ * kCell);
  const Vector offset = cell_start_.position - tip_ + e * (cell_start_.velocity + e * (square + e * cube));
  const Vector velocity = cell_start_.velocity + e * (2 * square + 3 * e * cube);
  const Vector bend = square + 3 * e * cube;

  const double k = grip_ * operator_->hand().stiffness_N_per_m;
  const double b = grip_ * operator_->hand().damping_N_s_per_m;
  JointDrive drive;
  drive.length_s = time::to_seconds(length);
  drive.torque = torque_;
  drive.hand_pull[0] = jacobian_.transpose() * (k * offset + b * velocity);
  drive.hand_pull[1] = jacobian_.transpose() * (k * velocity + 2 * b * bend);
  drive.hand_pull[2] = jacobian_.transpose() * (k * bend + 3 * b * cube);
  drive.hand_pull[3] = jacobian_.transpose() * (k * cube);
  motion_.advance(drive);
}

}  // namespace forcebound::device
