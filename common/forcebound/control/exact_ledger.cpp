#include "forcebound/control/exact_ledger.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "forcebound/control/diagonal_bound.hpp"
#include "forcebound/control/parabola_sum.hpp"

namespace forcebound::control {
namespace {

// A clock that says that next to no time has passed would credit any motion with any energy.
constexpr double kIntervalLeastPeriods = 0.1;
// What rounding may do to a reading, in parts of itself and of the encoder's step.
constexpr double kRounding = 1e-15;
constexpr double kStepRounding = 1e-9;

Bracket gain_of(const Uncertainty& uncertainty) {
  return {1 + uncertainty.torque_gain_share.least, 1 + uncertainty.torque_gain_share.most};
}

/// @param scale of damping and friction, with the least gain and with the most
template <typename Joint, std::size_t... Number>
std::array<Joint, kJointsMax> make_joints(const Vector& damping, const Vector& friction, const Bracket& scale,
                                          std::index_sequence<Number...> /*joints*/) {
  const auto joint = [&](std::size_t i) {
    const auto row = static_cast<Eigen::Index>(i);
    const auto scaled = [&](double by) {
      return row < damping.rows() ? LeastEnergy(by * damping[row], by * friction[row]) : LeastEnergy(1, 0);
    };
    return Joint{.least = scaled(scale.least), .most = scaled(scale.most), .more = {}};
  };
  return {joint(Number)...};
}

}  // namespace

ExactLedger::ExactLedger(const DeviceFacts& facts)
    : joint_count_(facts.joints()),
      // Proof, A1 and A2: at every instant so much of damping and friction is there.
      joints_(make_joints<Joint>((1 - facts.uncertainty.damping_share) * largest_diagonal_below(facts.damping),
                                 (1 - facts.uncertainty.friction_share) * facts.friction,
                                 facts.uncertainty.losses_with_gain ? gain_of(facts.uncertainty) : Bracket{1, 1},
                                 std::make_index_sequence<kJointsMax>())),
      encoder_half_((0.5 * (1 + kStepRounding) + facts.uncertainty.encoder_steps) * facts.encoder_step),
      period_s_(facts.period_s),
      times_(facts),
      paid_(times_.longest_release()),
      stamp_s_(facts.uncertainty.stamp_s),
      latency_s_(later_than_told(facts.uncertainty)),
      // Proof, A5: what a motor makes of a command is a constant times that, and a ripple.
      gain_(gain_of(facts.uncertainty)),
      ripple_share_(facts.uncertainty.torque_ripple_share),
      lag_s_(facts.uncertainty.actuator_lag_s),
      // Proof, A9: nothing is in effect before the first force.
      held_(joint_count_, lag_s_),
      committed_(Vector::Zero(joint_count_)) {}

void ExactLedger::pass(const Motion& motion) noexcept {
  queue_command(motion);
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

void ExactLedger::read(const Vector& joint) noexcept {
  // Proof, A10: V begins again only at the end of an interval whose both stamps are believed.
  if (!located_ && (blind_s_ > 0 || !stamps_.interval_believed())) return;
  for (Eigen::Index i = 0; i < joint_count_; ++i) {
    const LeastEnergy::Tube read = tube(i, joint[i]);
    add(i, [&](LeastEnergy& v, double /*gain*/) {
      const auto gained_J = located_ ? v.read(read) : std::nullopt;
      // What no finite motion explains was charged its worst case already: holding a force takes it from the minimum.
      if (!gained_J) v.restart(read);
      return gained_J.value_or(0);
    });
  }
  located_ = true;
}

/// Puts the force committed last among those on their way, with what the motion and the facts tell of its times.
void ExactLedger::queue_command(const Motion& motion) noexcept {
  // Proof, A6, A7 and A8: when it takes effect and ends, and that what is not said to have failed is carried out in
  // order.
  const Bracket begin_s = held_.in_order(times_.effect(motion));
  held_.command(committed_, begin_s, times_.release(motion, begin_s), !motion.write_failed);
  committed_.setZero();
}

void ExactLedger::let_act(double duration_s, double stretch) noexcept {
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
void ExactLedger::charge_all() noexcept {
  constexpr double kLagsUntilNothing = 40;
  if (located_ || blind_s_ > 0) {
    const Vector left = held_.left_by_lag();
    for (Eigen::Index i = 0; i < joint_count_; ++i) {
      held_.each([&](const Vector& mid, const Vector& spread) {
        add(i, [&](const LeastEnergy& v, double gain) { return -needed_J(v, gain * (std::abs(mid[i]) + spread[i])); });
      });
      add(i, [&](const LeastEnergy& v, double gain) { return -lag_can_take_J(v, gain * left[i]); });
    }
    const double over_s = held_.horizon_s() + paid_.part_s.most + kLagsUntilNothing * lag_s_;
    blind_s_ = std::max(blind_s_, over_s - std::min(0.0, stamp_s_.least));
  }
  located_ = false;
  held_ = HeldTorques(joint_count_, lag_s_);
}

/// Proof, A3: the encoder's true position lies within half a step of its reading, or so much more as the facts say.
LeastEnergy::Tube ExactLedger::tube(Eigen::Index joint, double reading) const noexcept {
  const double half = encoder_half_[joint];
  if (half == 0) return {reading, reading};
  const double wide = half + kRounding * std::abs(reading);
  return {reading - wide, reading + wide};
}

/// Proof, A6: the next force takes effect `latency_s` after the reading's stamp, or so much later as the facts allow.
ExactLedger::AtEffect ExactLedger::at_effect(double latency_s) const noexcept {
  const double begin_s = std::max(times_.true_time(latency_s).most + latency_s_.most, held_.horizon_s());
  AtEffect result;
  double taken_J = 0;
  double left_J = 0;
  // Adds what joint i loses to `sum_J` with the least gain, and to S by how much less that is than with the most.
  const auto take = [&](Eigen::Index i, double& sum_J, auto&& loss_J) {
    const double least_J = loss_J(joint(i).least, gain_.least);
    sum_J += least_J;
    if (gain_known()) return;
    result.more_at_most[static_cast<std::size_t>(i)] -= loss_J(joint(i).most, gain_.most) - least_J;
  };
  Vector left = held_.left_by_lag();
  held_.each_piece(stamp_s_.least, begin_s, [&](const Vector& mid, const Vector& spread, double piece_s) {
    for (Eigen::Index i = 0; i < joint_count_; ++i) {
      const double size = std::abs(mid[i]);
      take(i, taken_J, [&](const LeastEnergy& v, double gain) {
        return v.reserve_J(gain * mid[i], spread_of(gain * size, gain * spread[i]), piece_s);
      });
      left[i] = std::max(left[i], size + spread[i]);
    }
  });
  for (Eigen::Index i = 0; i < joint_count_; ++i) {
    take(i, left_J, [&](const LeastEnergy& v, double gain) { return lag_can_take_J(v, gain * left[i]); });
    result.lag_leaves = result.lag_leaves || lag_can_take_J(joint(i).most, gain_.most * left[i]) > 0;
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

std::optional<ExactLedger::AtEffect> ExactLedger::spendable(const AtEffect& left) noexcept {
  if (left.energy_J >= 0) return left;
  if (left.lag_leaves) return std::nullopt;
  return AtEffect{};
}

/// The most that the lag's rest of a torque of this size can take. Proof, A5: whatever the time constant up to lag_s.
double ExactLedger::lag_can_take_J(const LeastEnergy& joint, double left) const noexcept {
  return lag_s_ > 0 ? joint.reserve_J(left, ripple_share_ * left, lag_s_) : 0;
}

/// The sum over the stages of the release (proof, A7). Proof, A5: the torque may be larger by its ripple, and go on for
/// the lag.
double ExactLedger::needed_J(const LeastEnergy& joint, double torque) const noexcept {
  const double part_s = paid_.part_s.most - paid_.full_s.most;
  const auto stage_J = [&](double size, double duration_s) {
    return joint.reserve_J(size, ripple_share_ * size, duration_s);
  };
  const double needed_J = stage_J(torque, paid_.full_s.most + lag_s_);
  return part_s > 0 ? needed_J + stage_J(paid_.share * torque, part_s) : needed_J;
}

/// With what the joints have more at the most gain.
double ExactLedger::needed_J(const Vector& torque, const PerJoint& more_at_most) const noexcept {
  double needed_J = 0;
  for (Eigen::Index i = 0; i < joint_count_; ++i) {
    const double size = std::abs(torque[i]);
    double joint_J = this->needed_J(joint(i).least, gain_.least * size);
    if (!gain_known()) {
      const double most_J = this->needed_J(joint(i).most, gain_.most * size);
      joint_J = std::max(joint_J, most_J - more_at_most[static_cast<std::size_t>(i)]);
    }
    needed_J += joint_J;
  }
  return needed_J;
}

/// For a torque > 0, its ripple included; it begins to need something where friction is overcome.
std::array<ExactLedger::Stage, 2> ExactLedger::stages(const LeastEnergy& joint, double torque) const noexcept {
  const auto stage = [&](double size, double duration_s) {
    return Stage{joint.friction() / size, size * size * duration_s / (4 * joint.damping())};
  };
  const Stage full = stage(torque, paid_.full_s.most + lag_s_);
  const double part = paid_.share * torque;
  return {full, part > 0 ? stage(part, paid_.part_s.most - paid_.full_s.most) : Stage{full.begin, 0}};
}

/// The largest s with needed_J(s torque) <= energy: a parabola for each joint and stage, from where its friction is
/// overcome on; where the most gain begins to need more than a joint has more with it, those of the most gain.
double ExactLedger::largest_scale(const Vector& torque, const AtEffect& spendable) const noexcept {
  ParabolaSum<5 * kJointsMax> needed;
  for (Eigen::Index i = 0; i < joint_count_; ++i) {
    const double size = std::abs(torque[i]) * (1 + ripple_share_);
    if (!(size > 0)) continue;
    const auto least = stages(joint(i).least, gain_.least * size);
    if (gain_known()) {
      for (const Stage& stage : least) needed.bend(stage.begin, 0, stage.weight);
      continue;
    }
    const auto most = stages(joint(i).most, gain_.most * size);
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

Vector ExactLedger::largest_held() const noexcept {
  Vector largest = Vector::Zero(joint_count_);
  held_.each([&](const Vector& mid, const Vector& spread) { largest = largest.cwiseMax(mid.cwiseAbs() + spread); });
  return largest;
}

bool ExactLedger::knots_merged() const noexcept {
  return std::any_of(joints_.begin(), joints_.end(),
                     [](const Joint& joint) { return joint.least.merged() || joint.most.merged(); });
}

}  // namespace forcebound::control
