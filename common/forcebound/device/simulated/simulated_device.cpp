#include "forcebound/device/simulated/simulated_device.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/control/rotation.hpp"

namespace forcebound::device {
namespace {

constexpr Nanoseconds kCell = std::chrono::milliseconds(1);
constexpr double kRateMax = 1e5;  // 1/s

std::unique_ptr<const Operator> checked(std::unique_ptr<const Operator> hand, const control::DeviceFacts& facts) {
  if (hand->degrees_of_freedom() == facts.translations()) return hand;
  control::ClassicText text;
  text << "operator '" << hand->name() << "' moves " << hand->degrees_of_freedom() << " degrees of freedom, device '"
       << facts.name << "' has " << facts.translations();
  throw std::invalid_argument(text.str());
}

}  // namespace

control::Uncertainty bounds_of(const DeviceFlaws& flaws) noexcept {
  const double frame_s = time::to_seconds(flaws.frame);
  // A clock of its own is read to a nanosecond, of 0.1 ms at least.
  const double rounding = flaws.clock_share == 0 ? 0 : 1e-5;
  return {.stamp_s = {flaws.stamp_s.least - frame_s, flaws.stamp_s.most},
          .latency_s = {flaws.latency_s.least, flaws.latency_s.most + frame_s},
          .latency_offset_s = flaws.latency_offset_s,
          .hold_s = flaws.hold_s,
          .clock_share = std::abs(flaws.clock_share) + rounding,
          .encoder_steps = flaws.encoder_steps,
          .damping_share = flaws.damping_share,
          .friction_share = flaws.friction_share,
          .torque_gain_share = flaws.torque_gain_share,
          .torque_ripple_share = flaws.torque_ripple_share,
          .actuator_lag_s = flaws.actuator_lag_s};
}

SimulatedDevice::SimulatedDevice(DeviceDescription description, std::unique_ptr<const Operator> hand,
                                 const DeviceFlaws& flaws)
    : description_(std::move(description)),
      operator_(checked(std::move(hand), description_.facts)),
      kinematics_(make_kinematics(description_.geometry)),
      motion_((1 - flaws.damping_share) * description_.facts.damping,
              (1 - flaws.friction_share) * description_.facts.friction,
              kinematics_->joints_at_pose(operator_->target(0).position, control::turn_by(operator_->turn(0)))),
      tip_damping_(
          description_.facts.cartesian
              ? control::Damping::from_matrix(description_.facts.damping)
              : control::Damping::from_joints(kinematics_->jacobian(motion_.position()), description_.facts.damping)),
      flaws_(flaws),
      random_(flaws.seed),
      gain_(drawn_gain(motion_.position().size())),
      offset_(drawn_s(flaws_.latency_offset_s)),
      lost_(Vector::Zero(motion_.position().size())),
      torque_(Vector::Zero(motion_.position().size())),
      command_(torque_),
      lagged_(torque_) {
  reading_jacobian_ = kinematics_->jacobian(motion_.position());
  linearise();
  const double rate = motion_.fastest_rate();
  if (rate <= kRateMax) return;
  control::ClassicText text;
  text << "device '" << facts().name << "' with operator '" << operator_->name() << "' has a time constant of "
       << 1 / rate << " s; it must be >= " << 1 / kRateMax << " s: more mass, or less damping or stiffness";
  throw std::invalid_argument(text.str());
}

Reading SimulatedDevice::read(Nanoseconds now) noexcept {
  const Nanoseconds off = flaws_.stamp_s == control::Bracket{} ? Nanoseconds{0} : drawn_s(flaws_.stamp_s);
  advance_to(now + std::min(off, Nanoseconds{0}));
  Reading reading;
  if (flaws_.stale_readings > 0 && number(0, 1) < flaws_.stale_readings) {
    reading.status = Reading::Status::stale;
    reading.latched = now;
    return reading;
  }
  reading.joint = framed_ ? *framed_ : motion_.position();
  read_encoders(reading.joint);
  reading.position = kinematics_->position(reading.joint);
  if (!facts().cartesian) {
    reading_jacobian_ = kinematics_->jacobian(reading.joint);
    tip_damping_ = control::Damping::from_joints(reading_jacobian_, facts().damping);
  }
  reading.jacobian = reading_jacobian_;
  reading.damping = &tip_damping_;
  reading.latched = std::min(now, shown_time(time_) - off);
  if (framed_ || off == Nanoseconds{0}) reading.latched = now;
  reading.handle = control::sound(operator_->handle(time::to_seconds(time_))).handle;
  if (const auto turned = kinematics_->orientation(reading.joint)) {
    reading.handle.orientation = control::orientation_of(*turned);
  }
  return reading;
}

void SimulatedDevice::apply(Nanoseconds now, const Vector& force_N) noexcept {
  advance_to(now);
  const bool sound = force_N.size() == facts().degrees_of_freedom() && force_N.allFinite();
  counters_.faulty_commands += !sound;
  effective_at_.reset();
  released_at_.reset();
  write_failed_ = flaws_.failed_writes > 0 && number(0, 1) < flaws_.failed_writes;
  counters_.failed_writes += write_failed_;
  if (write_failed_) {
    write_failed_ = flaws_.failures_reported;
    return;
  }
  const Nanoseconds before = pending_count_ > 0 ? pending_[static_cast<std::size_t>(pending_count_ - 1)].effect : time_;
  // If the queue is full, the command replaces the newest one in it.
  pending_count_ = std::min(pending_count_ + 1, kPendingMax);
  Command& command = pending_[static_cast<std::size_t>(pending_count_ - 1)];
  command.effect = time_ + time::from_seconds(facts().latency_s) + offset_ + drawn_s(flaws_.latency_s);
  if (flaws_.frame > Nanoseconds{0})
    command.effect = (command.effect + flaws_.frame - Nanoseconds{1}) / flaws_.frame * flaws_.frame;
  command.effect = std::max(command.effect, before);
  command.torque.setZero(torque_.size());
  if (sound) command.torque.noalias() = reading_jacobian_.transpose() * force_N;
  if (!command.torque.allFinite()) command.torque.setZero();
  change_torque();
}

SimulatedDevice::Truth SimulatedDevice::truth() const noexcept {
  const Vector& joint = motion_.position();
  const Vector tip = kinematics_->jacobian(joint) * motion_.velocity();
  const Eigen::Index translations = facts().translations();
  return {joint, motion_.velocity(), kinematics_->position(joint), tip.head(translations),
          tip.tail(tip.rows() - translations)};
}

DeviceCounters SimulatedDevice::counters() const noexcept {
  DeviceCounters counters = counters_;
  counters.frozen_joints = motion_.frozen_joints();
  return counters;
}

void SimulatedDevice::advance_to(Nanoseconds now) noexcept {
  if (!origin_) origin_ = now;
  Nanoseconds end = true_time(now);
  const Nanoseconds excess = end - time_ - kGapMax;
  if (excess > Nanoseconds{0}) end -= excess;
  while (time_ < end) {
    const std::int64_t cell = time_ / kCell;
    if (cell != cell_) enter_cell(cell);
    Nanoseconds next = std::min(end, (cell + 1) * kCell);
    if (pending_count_ > 0) next = std::min(next, std::max(pending_[0].effect, time_));
    next = std::min(next, time_ + longest_piece());
    if (flaws_.frame > Nanoseconds{0}) next = std::min(next, (time_ / flaws_.frame + 1) * flaws_.frame);
    if (release_) next = std::min(next, *release_);
    move_motors(time::to_seconds(next - time_));
    integrate(next - time_);
    time_ = next;
    if (flaws_.frame > Nanoseconds{0} && time_ % flaws_.frame == Nanoseconds{0}) framed_ = motion_.position();
    change_torque();
  }
  if (excess > Nanoseconds{0}) {
    *origin_ += excess;
    ++counters_.gaps_cut;
  }
}

void SimulatedDevice::change_torque() noexcept {
  if (release_ && *release_ <= time_) let_go();
  while (pending_count_ > 0 && pending_[0].effect <= time_) {
    command_ = gain_.cwiseProduct(pending_[0].torque);
    if (pending_count_ == 1 && flaws_.effects_reported && !write_failed_)
      effective_at_ = shown_time(pending_[0].effect);
    release_.reset();
    released_in_full_.reset();
    if (facts().releases) {
      const bool staged = facts().release_share > 0 && facts().release_s > 0;
      const Nanoseconds held = pending_[0].effect + time::from_seconds(facts().hold_s_max);
      release_ = std::max(time_, held + drawn_s(flaws_.hold_s));
      released_in_full_ =
          staged ? std::max(*release_, held + time::from_seconds(facts().release_s) + drawn_s(flaws_.hold_s))
                 : *release_;
    }
    std::move(pending_.begin() + 1, pending_.begin() + pending_count_, pending_.begin());
    --pending_count_;
  }
  if (flaws_.actuator_lag_s == 0) torque_ = command_;
}

/// The next stage of the release.
void SimulatedDevice::let_go() noexcept {
  const bool in_full = *released_in_full_ <= *release_;
  if (pending_count_ == 0 && !released_at_ && flaws_.releases_reported) released_at_ = shown_time(*release_);
  command_ *= in_full ? 0 : facts().release_share;
  release_ = in_full ? std::nullopt : released_in_full_;
}

Nanoseconds SimulatedDevice::true_time(Nanoseconds now) const noexcept {
  const Nanoseconds shown = now - *origin_;
  if (flaws_.clock_share == 0) return shown;
  return Nanoseconds(std::llround(static_cast<double>(shown.count()) / (1 + flaws_.clock_share)));
}

Nanoseconds SimulatedDevice::shown_time(Nanoseconds true_time) const noexcept {
  if (flaws_.clock_share == 0) return *origin_ + true_time;
  return *origin_ + Nanoseconds(std::llround(static_cast<double>(true_time.count()) * (1 + flaws_.clock_share)));
}

/// For so long a torque may be taken for constant that follows a command or the motion.
Nanoseconds SimulatedDevice::longest_piece() const noexcept {
  constexpr Nanoseconds kRipple = std::chrono::microseconds(100);
  constexpr double kLagPieces = 8;
  Nanoseconds longest = flaws_.torque_ripple_share > 0 ? kRipple : kCell;
  if (flaws_.actuator_lag_s > 0) {
    longest = std::min(longest, std::max(time::from_seconds(flaws_.actuator_lag_s / kLagPieces), Nanoseconds{1000}));
  }
  return longest;
}

/// The torque of the coming piece: what a lag has come to at its end, which is no slower than that lag, and off by a
/// share of it, along with the motion.
void SimulatedDevice::move_motors(double length_s) noexcept {
  if (flaws_.actuator_lag_s > 0)
    torque_ = command_ + std::exp(-length_s / flaws_.actuator_lag_s) * (lagged_ - command_);
  lagged_ = torque_;
  if (flaws_.torque_ripple_share == 0) return;
  for (Eigen::Index i = 0; i < torque_.size(); ++i) {
    const double with_motion = torque_[i] * motion_.velocity()[i] >= 0 ? 1 : -1;
    torque_[i] *= 1 + with_motion * flaws_.torque_ripple_share;
  }
}

void SimulatedDevice::read_encoders(Vector& joint) noexcept {
  for (Eigen::Index i = 0; i < joint.size(); ++i) {
    const double step = facts().encoder_step[i];
    if (step == 0) continue;
    double off = 0;
    if (flaws_.encoder_steps > 0) off = flaws_.encoder_steps * number(-1, 1);
    if (flaws_.lost_counts > 0 && number(0, 1) < flaws_.lost_counts) lost_[i] += number(0, 1) < 0.5 ? step : -step;
    joint[i] = step * std::round(joint[i] / step + off) + lost_[i];
  }
}

/// Mostly one of its ends.
double SimulatedDevice::drawn(const control::Bracket& bracket) noexcept {
  if (bracket.least == bracket.most) return bracket.least;
  constexpr double kEnds = 0.7;
  const double where = number(0, 1) < kEnds ? std::round(number(0, 1)) : number(0, 1);
  return bracket.least + where * (bracket.most - bracket.least);
}

Nanoseconds SimulatedDevice::drawn_s(const control::Bracket& bracket_s) noexcept {
  return time::from_seconds(drawn(bracket_s));
}

Vector SimulatedDevice::drawn_gain(Eigen::Index joints) noexcept {
  return Vector::NullaryExpr(joints, [this](Eigen::Index) { return 1 + drawn(flaws_.torque_gain_share); });
}

double SimulatedDevice::number(double low, double high) noexcept {
  return std::uniform_real_distribution<double>(low, high)(random_);
}

void SimulatedDevice::enter_cell(std::int64_t cell) noexcept {
  const auto target_at = [this](std::int64_t knot) { return operator_->target(time::to_seconds(knot * kCell)); };
  cell_start_ = cell == cell_ + 1 && cell > 0 ? cell_end_ : target_at(cell);
  cell_end_ = target_at(cell + 1);
  cell_ = cell;
  if (facts().rotations > 0) {
    const auto turn_at = [this](std::int64_t knot) {
      return control::turn_by(operator_->turn(time::to_seconds(knot * kCell)));
    };
    turn_start_ = turn_at(cell);
    turn_rad_ = control::rotation_vector(turn_start_, turn_at(cell + 1));
  }
  if (cell_start_.grip == grip_) return;
  grip_ = cell_start_.grip;
  linearise();
}

void SimulatedDevice::linearise() noexcept {
  const Hand& hand = operator_->hand();
  jacobian_ = kinematics_->jacobian(motion_.position());
  motion_.set_system({.inertia = description_.inertia + metric(hand.mass_kg, hand.inertia_kg_m2),
                      .damping = (1 - flaws_.damping_share) * facts().damping +
                                 grip_ * metric(hand.damping_N_s_per_m, hand.rotation_damping_N_m_s_per_rad),
                      .stiffness = grip_ * metric(hand.stiffness_N_per_m, hand.rotation_stiffness_N_m_per_rad)});
}

/// In the joints: what the hand has of it for each translation and each rotation.
Matrix SimulatedDevice::metric(double translation, double rotation) const noexcept {
  const auto along = jacobian_.topRows(facts().translations());
  Matrix metric = translation * (along.transpose() * along);
  if (facts().rotations > 0) {
    const auto about = jacobian_.bottomRows(facts().rotations);
    metric += rotation * (about.transpose() * about);
  }
  return metric;
}

/// The hand's pull about the tip, from this instant of the cell on.
void SimulatedDevice::turn_by_hand(JointDrive& drive, double elapsed_s) const noexcept {
  const auto here = kinematics_->orientation(motion_.position());
  if (!here) return;
  const double cell_s = time::to_seconds(kCell);
  const Eigen::Quaterniond wanted = control::turn_by(elapsed_s / cell_s * turn_rad_) * turn_start_;
  const Vector offset = control::rotation_vector(*here, wanted);
  const Vector rate = turn_rad_ / cell_s;
  const double k = grip_ * operator_->hand().rotation_stiffness_N_m_per_rad;
  const double b = grip_ * operator_->hand().rotation_damping_N_m_s_per_rad;
  const auto about = jacobian_.bottomRows(facts().rotations);
  drive.hand_pull[0] += about.transpose() * (k * offset + b * rate);
  drive.hand_pull[1] += about.transpose() * (k * rate);
}

void SimulatedDevice::integrate(Nanoseconds length) noexcept {
  if (!facts().cartesian) linearise();
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
  const auto along = jacobian_.topRows(facts().translations());
  drive.hand_pull[0] = along.transpose() * (k * offset + b * velocity);
  drive.hand_pull[1] = along.transpose() * (k * velocity + 2 * b * bend);
  drive.hand_pull[2] = along.transpose() * (k * bend + 3 * b * cube);
  drive.hand_pull[3] = along.transpose() * (k * cube);
  turn_by_hand(drive, e);
  motion_.advance(drive);
}

}  // namespace forcebound::device
