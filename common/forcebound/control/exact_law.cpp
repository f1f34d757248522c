#include "forcebound/control/exact_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "forcebound/control/assertion.hpp"
#include "forcebound/control/classic_text.hpp"
#include "forcebound/control/damping.hpp"
#include "forcebound/control/diagonal_bound.hpp"
#include "forcebound/control/parabola_sum.hpp"

namespace forcebound::control {
namespace {

// A clock that says that next to no time has passed would credit any motion with any energy.
constexpr double kIntervalLeastPeriods = 0.1;
constexpr double kLatencyMaxPeriods = 8;
// What rounding may do to a reading, in parts of itself and of the encoder's step.
constexpr double kRounding = 1e-15;
constexpr double kStepRounding = 1e-9;

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

template <typename Joint, std::size_t... Number>
std::array<Joint, kJointsMax> make_joints(const Vector& damping, const Vector& friction,
                                          std::index_sequence<Number...> /*joints*/) {
  const auto joint = [&](std::size_t i) {
    const auto row = static_cast<Eigen::Index>(i);
    const LeastEnergy least = row < damping.rows() ? LeastEnergy(damping[row], friction[row]) : LeastEnergy(1, 0);
    return Joint{.least = least, .most = least, .more = {}};
  };
  return {joint(Number)...};
}

}  // namespace

ExactLaw::ExactLaw(const DeviceFacts& facts, EnergyMemory memory, const Spending& spending)
    : joint_count_((check(facts), facts.joints())),
      dof_(facts.degrees_of_freedom()),
      // Proof, A1 and A2: at every instant so much of damping and friction is there.
      joints_(make_joints<Joint>((1 - facts.uncertainty.damping_share) * largest_diagonal_below(facts.damping),
                                 (1 - facts.uncertainty.friction_share) * facts.friction,
                                 std::make_index_sequence<kJointsMax>())),
      encoder_half_((0.5 * (1 + kStepRounding) + facts.uncertainty.encoder_steps) * facts.encoder_step),
      period_s_(facts.period_s),
      times_(facts),
      paid_(times_.longest_release()),
      stamp_s_(facts.uncertainty.stamp_s),
      latency_s_(facts.uncertainty.latency_s),
      // Proof, A5: what a motor makes of a command is a constant times that, and a ripple.
      gain_{1 + facts.uncertainty.torque_gain_share.least, 1 + facts.uncertainty.torque_gain_share.most},
      ripple_share_(facts.uncertainty.torque_ripple_share),
      lag_s_(facts.uncertainty.actuator_lag_s),
      force_N_max_(facts.force_N_max),
      torque_N_m_max_(facts.torque_N_m_max),
      rotations_(facts.rotations),
      memory_(memory),
      spending_(spending),
      jacobian_(Matrix::Identity(dof_, joint_count_)),
      // Proof, A9: nothing is in effect before the first force.
      held_(joint_count_, lag_s_),
      committed_(Vector::Zero(joint_count_)) {}

void ExactLaw::credit(const Motion& motion) noexcept {
  FORCEBOUND_ASSERT(motion.joint.rows() == joint_count_, "a reading has a row for each joint");
  note_times(motion);
  jacobian_ = motion.jacobian;
  // Proof, A10: V begins again only at the end of an interval whose both stamps are believed.
  if (!located_ && (blind_s_ > 0 || !stamps_.interval_believed())) return;
  for (Eigen::Index i = 0; i < joint_count_; ++i) {
    const LeastEnergy::Tube read = tube(i, motion.joint[i]);
    add(i, [&](LeastEnergy& v, double /*gain*/) {
      const auto gained_J = located_ ? v.read(read) : std::nullopt;
      // What no finite motion explains was charged its worst case already: holding a force takes it from the minimum.
      if (!gained_J) v.restart(read);
      return gained_J.value_or(0);
    });
  }
  located_ = true;
  if (memory_ == EnergyMemory::capped) forget_excess();
}

void ExactLaw::lose(const Motion& motion) noexcept { note_times(motion); }

/// Lets the time since the previous reading pass over V and over the forces in effect.
void ExactLaw::note_times(const Motion& motion) noexcept {
  latency_s_max_ = std::max(0.0, motion.latency_s_max);
  note_command(motion);
  interval_s_ = motion.interval_s;
  stamps_.pass(motion.interval_s);
  if (!is_measurable(motion.interval_s)) {
    charge_all();
    return;
  }
  // Proof, A4: so long it was by a true clock, and a reading is of within stamp_s of its stamp.
  const Bracket passed_s = times_.true_time(motion.interval_s);
  if (located_) {
    let_act(passed_s.most, std::max(1.0, kIntervalLeastPeriods * period_s_ / motion.interval_s));
  } else if (stamps_.interval_believed()) {
    blind_s_ -= passed_s.least;
  }
  held_.pass(passed_s, stamp_s_.least);
}

/// Puts the force committed last among those on their way, with what the motion and the facts tell of its times.
void ExactLaw::note_command(const Motion& motion) noexcept {
  // Proof, A6, A7 and A8: when it takes effect and ends, and that what is not said to have failed is carried out in
  // order.
  const Bracket begin_s = held_.in_order(times_.effect(motion));
  held_.command(committed_, begin_s, times_.release(motion, begin_s), !motion.write_failed);
  committed_.setZero();
}

void ExactLaw::let_act(double duration_s, double stretch) noexcept {
  held_.each_piece(
      stamp_s_.least, duration_s + stamp_s_.most, [&](const Vector& mid, const Vector& spread, double piece_s) {
        for (Eigen::Index i = 0; i < joint_count_; ++i) {
          add(i, [&](LeastEnergy& v, double gain) {
            return v.hold(gain * mid[i], spread_of(gain * std::abs(mid[i]), gain * spread[i]), piece_s * stretch);
          });
        }
      });
}

/// Nobody knows how long the forces in effect and on their way have been or will be: each is charged as long as any can
/// be, and until the last must be over, nothing is credited.
void ExactLaw::charge_all() noexcept {
  constexpr double kLagsUntilNothing = 40;
  if (located_ || blind_s_ > 0) {
    const Vector left = held_.left_by_lag();
    for (Eigen::Index i = 0; i < joint_count_; ++i) {
      held_.each([&](const Vector& mid, const Vector& spread) {
        add(i, [&](const LeastEnergy&, double gain) { return -needed_J(i, gain * (std::abs(mid[i]) + spread[i])); });
      });
      add(i, [&](const LeastEnergy&, double gain) { return -lag_can_take_J(i, gain * left[i]); });
    }
    const double over_s = held_.horizon_s() + paid_.part_s.most + kLagsUntilNothing * lag_s_;
    blind_s_ = std::max(blind_s_, over_s - std::min(0.0, stamp_s_.least));
  }
  located_ = false;
  held_ = HeldTorques(joint_count_, lag_s_);
}

void ExactLaw::forget_excess() noexcept {
  constexpr double kRoom = 1 + 1e-12;  // rounding shall not bound the largest force
  Vector largest = force_N_max_ * jacobian_.topRows(dof_ - rotations_).colwise().norm().transpose();
  if (rotations_ > 0) largest += torque_N_m_max_ * jacobian_.bottomRows(rotations_).colwise().norm().transpose();
  const double kept_J = std::min(kRoom * spending_.memory_reserves * needed_J(largest, {}), spending_.memory_J_max);
  // If the write of the next force fails, those told so far go on until their release.
  Vector held = Vector::Zero(joint_count_);
  held_.each([&](const Vector& mid, const Vector& spread) { held = held.cwiseMax(mid.cwiseAbs() + spread); });
  const double excess_J = energy_J() - std::max(kept_J, needed_J(held, {}));
  if (!(excess_J > 0)) return;
  energy_.add(-excess_J);
  given_.add(excess_J);
}

void ExactLaw::receive_energy(double energy_J) noexcept {
  FORCEBOUND_ASSERT(energy_J >= 0, "energy received is a number and not negative");
  energy_.add(energy_J);
}

/// Proof, A3: the encoder's true position lies within half a step of its reading, or so much more as the facts say.
LeastEnergy::Tube ExactLaw::tube(Eigen::Index joint, double reading) const noexcept {
  const double half = encoder_half_[joint];
  if (half == 0) return {reading, reading};
  const double wide = half + kRounding * std::abs(reading);
  return {reading - wide, reading + wide};
}

/// Proof, A6: the next force takes effect `latency_s` after the reading's stamp, or so much later as the facts allow.
ExactLaw::AtEffect ExactLaw::at_effect(double latency_s) const noexcept {
  const double begin_s = std::max(times_.true_time(latency_s).most + latency_s_.most, held_.horizon_s());
  AtEffect result;
  double taken_J = 0;
  double left_J = 0;
  // Adds what joint i loses to `sum_J` with the least gain, and to S by how much less that is than with the most.
  const auto take = [&](Eigen::Index i, double& sum_J, auto&& loss_J) {
    const double least_J = loss_J(gain_.least);
    sum_J += least_J;
    if (!gain_known()) result.more_at_most[static_cast<std::size_t>(i)] -= loss_J(gain_.most) - least_J;
  };
  Vector left = held_.left_by_lag();
  held_.each_piece(stamp_s_.least, begin_s, [&](const Vector& mid, const Vector& spread, double piece_s) {
    for (Eigen::Index i = 0; i < joint_count_; ++i) {
      const double size = std::abs(mid[i]);
      take(i, taken_J, [&](double gain) {
        return joint(i).least.reserve_J(gain * mid[i], spread_of(gain * size, gain * spread[i]), piece_s);
      });
      left[i] = std::max(left[i], size + spread[i]);
    }
  });
  for (Eigen::Index i = 0; i < joint_count_; ++i) {
    take(i, left_J, [&](double gain) { return lag_can_take_J(i, gain * left[i]); });
    result.lag_leaves = result.lag_leaves || lag_can_take_J(i, gain_.most * left[i]) > 0;
  }
  result.energy_J = energy_.value_J() - taken_J - left_J;
  for (Eigen::Index i = 0; i < joint_count_ && !gain_known(); ++i) {
    double& more_J = result.more_at_most[static_cast<std::size_t>(i)];
    more_J += joint(i).more.value_J();
    result.energy_J += std::min(more_J, 0.0);
    more_J = std::max(more_J, 0.0);
  }
  return result;
}

/// What the next force may need. Nothing where not even the torque that friction holds is safe: with a deficit, while
/// the lag has left something of a torque above it.
std::optional<ExactLaw::AtEffect> ExactLaw::spendable(double latency_s) const noexcept {
  const AtEffect left = at_effect(latency_s);
  if (left.energy_J >= 0) return left;
  if (left.lag_leaves) return std::nullopt;
  return AtEffect{};
}

/// The most that the lag's rest of a torque of this size can take. Proof, A5: whatever the time constant up to lag_s.
double ExactLaw::lag_can_take_J(Eigen::Index i, double left) const noexcept {
  return lag_s_ > 0 ? joint(i).least.reserve_J(left, ripple_share_ * left, lag_s_) : 0;
}

/// The sum over the stages of the release (proof, A7). Proof, A5: the torque may be larger by its ripple, and go on for
/// the lag.
double ExactLaw::needed_J(Eigen::Index i, double torque) const noexcept {
  const double part_s = paid_.part_s.most - paid_.full_s.most;
  const auto stage_J = [&](double size, double duration_s) {
    return joint(i).least.reserve_J(size, ripple_share_ * size, duration_s);
  };
  const double needed_J = stage_J(torque, paid_.full_s.most + lag_s_);
  return part_s > 0 ? needed_J + stage_J(paid_.share * torque, part_s) : needed_J;
}

/// With what the joints have more at the most gain.
double ExactLaw::needed_J(const Vector& torque, const PerJoint& more_at_most) const noexcept {
  double needed_J = 0;
  for (Eigen::Index i = 0; i < joint_count_; ++i) {
    const double size = std::abs(torque[i]);
    double joint_J = this->needed_J(i, gain_.least * size);
    if (!gain_known()) {
      joint_J = std::max(joint_J, this->needed_J(i, gain_.most * size) - more_at_most[static_cast<std::size_t>(i)]);
    }
    needed_J += joint_J;
  }
  return needed_J;
}

Vector ExactLaw::bound(const Vector& request_N) noexcept {
  const double largest = request_N.lpNorm<Eigen::Infinity>();
  if (!(largest > 0) || !located_) {
    shown_share_ = 1;
    return Vector::Zero(dof_);
  }
  // Through its largest component, so that neither 1e300 N nor 1e-300 N leaves the range of a double when squared.
  const Vector direction = request_N / largest;
  const auto left = spendable(latency_s_max_);
  double scale = left ? std::min(largest, largest_scale(jacobian_.transpose() * direction, *left)) : 0.0;
  if (memory_ == EnergyMemory::capped) {
    const double share = std::min(scale / largest, shown_share_ + spending_.rise_per_s * std::max(0.0, interval_s_));
    if (share < scale / largest) scale = share * largest;
    shown_share_ = share;
  }
  return scale == largest ? request_N : Vector(direction * scale);
}

/// For a torque > 0, its ripple included; it begins to need something where friction is overcome.
std::array<ExactLaw::Stage, 2> ExactLaw::stages(Eigen::Index i, double torque) const noexcept {
  const LeastEnergy& least = joint(i).least;
  const auto stage = [&](double size, double duration_s) {
    return Stage{least.friction() / size, size * size * duration_s / (4 * least.damping())};
  };
  const Stage full = stage(torque, paid_.full_s.most + lag_s_);
  const double part = paid_.share * torque;
  return {full, part > 0 ? stage(part, paid_.part_s.most - paid_.full_s.most) : Stage{full.begin, 0}};
}

/// The largest s with needed_J(s torque) <= energy: a parabola for each joint and stage, from where its friction is
/// overcome on; where the most gain begins to need more than a joint has more with it, those of the most gain.
double ExactLaw::largest_scale(const Vector& torque, const AtEffect& spendable) const noexcept {
  ParabolaSum<5 * kJointsMax> needed;
  for (Eigen::Index i = 0; i < joint_count_; ++i) {
    const double size = std::abs(torque[i]) * (1 + ripple_share_);
    if (!(size > 0)) continue;
    const auto least = stages(i, gain_.least * size);
    if (gain_known()) {
      for (const Stage& stage : least) needed.bend(stage.begin, 0, stage.weight);
      continue;
    }
    const auto most = stages(i, gain_.most * size);
    ParabolaSum<4> difference;
    for (const Stage& stage : most) difference.bend(stage.begin, 0, stage.weight);
    for (const Stage& stage : least) difference.bend(stage.begin, 0, -stage.weight);
    const double turn = difference.reach(spendable.more_at_most[static_cast<std::size_t>(i)]);
    double slope = 0;
    double curvature = 0;
    for (const Stage& stage : least) {
      if (!(stage.begin < turn)) continue;
      needed.bend(stage.begin, 0, stage.weight);
      slope -= stage.weight * (turn - stage.begin);
      curvature -= stage.weight;
    }
    for (const Stage& stage : most) {
      if (stage.begin < turn) {
        slope += stage.weight * (turn - stage.begin);
        curvature += stage.weight;
      } else {
        needed.bend(stage.begin, 0, stage.weight);
      }
    }
    needed.bend(turn, slope, curvature);
  }
  return needed.reach(spendable.energy_J);
}

bool ExactLaw::allows(const Vector& force_N, double latency_s) const noexcept {
  constexpr double kForceRounding = 1e-12;
  if (force_N.isZero(0)) return true;
  if (!located_) return false;
  const Vector torque = jacobian_.transpose() * force_N * (1 - kForceRounding);
  const auto left = spendable(latency_s);
  return left && needed_J(torque, left->more_at_most) <= left->energy_J;
}

void ExactLaw::commit(const Vector& force_N) noexcept { committed_ = jacobian_.transpose() * force_N; }

bool ExactLaw::knots_merged() const noexcept {
  return std::any_of(joints_.begin(), joints_.end(),
                     [](const Joint& joint) { return joint.least.merged() || joint.most.merged(); });
}

}  // namespace forcebound::control
