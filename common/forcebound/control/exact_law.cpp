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
  share("uncertainty of the torque must be a share of 0 to less than 1", uncertainty.torque_share);
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

template <std::size_t... Joint>
std::array<LeastEnergy, kJointsMax> make_joints(const Vector& damping, const Vector& friction,
                                                std::index_sequence<Joint...> /*joints*/) {
  const auto joint = [&](std::size_t i) {
    const auto row = static_cast<Eigen::Index>(i);
    return row < damping.rows() ? LeastEnergy(damping[row], friction[row]) : LeastEnergy(1, 0);
  };
  return {joint(Joint)...};
}

}  // namespace

ExactLaw::ExactLaw(const DeviceFacts& facts, EnergyMemory memory, const Spending& spending)
    : joint_count_((check(facts), facts.joints())),
      dof_(facts.degrees_of_freedom()),
      // Proof, A1 and A2: at every instant so much of damping and friction is there.
      joints_(make_joints((1 - facts.uncertainty.damping_share) * largest_diagonal_below(facts.damping),
                          (1 - facts.uncertainty.friction_share) * facts.friction,
                          std::make_index_sequence<kJointsMax>())),
      encoder_half_((0.5 * (1 + kStepRounding) + facts.uncertainty.encoder_steps) * facts.encoder_step),
      period_s_(facts.period_s),
      times_(facts),
      paid_(times_.longest_release()),
      stamp_s_(facts.uncertainty.stamp_s),
      latency_s_(facts.uncertainty.latency_s),
      torque_share_(facts.uncertainty.torque_share),
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
    LeastEnergy& joint = joints_[static_cast<std::size_t>(i)];
    const LeastEnergy::Tube read = tube(i, motion.joint[i]);
    const auto gain_J = located_ ? joint.read(read) : std::nullopt;
    // What no finite motion explains was charged its worst case already: holding a force takes it from the minimum.
    if (!gain_J) joint.restart(read);
    energy_.add(gain_J.value_or(0));
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
  held_.each_piece(stamp_s_.least, duration_s + stamp_s_.most,
                   [&](const Vector& mid, const Vector& spread, double piece_s) {
                     for (Eigen::Index i = 0; i < joint_count_; ++i) {
                       energy_.add(joints_[static_cast<std::size_t>(i)].hold(
                           mid[i], spread_of(std::abs(mid[i]), spread[i]), piece_s * stretch));
                     }
                   });
}

/// Nobody knows how long the forces in effect and on their way have been or will be: each is charged as long as any can
/// be, and until the last must be over, nothing is credited.
void ExactLaw::charge_all() noexcept {
  constexpr double kLagsUntilNothing = 40;
  if (located_ || blind_s_ > 0) {
    held_.each([&](const Vector& mid, const Vector& spread) { energy_.add(-needed_J(mid.cwiseAbs() + spread)); });
    energy_.add(-lag_can_take_J(held_.left_by_lag()));
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
  const double kept_J = std::min(kRoom * spending_.memory_reserves * needed_J(largest), spending_.memory_J_max);
  // If the write of the next force fails, those told so far go on until their release.
  Vector held = Vector::Zero(joint_count_);
  held_.each([&](const Vector& mid, const Vector& spread) { held = held.cwiseMax(mid.cwiseAbs() + spread); });
  const double excess_J = energy_J() - std::max(kept_J, needed_J(held));
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
ExactLaw::Ahead ExactLaw::until_effect(double latency_s) const noexcept {
  const double begin_s = std::max(times_.true_time(latency_s).most + latency_s_.most, held_.horizon_s());
  Ahead ahead;
  Vector left = held_.left_by_lag();
  held_.each_piece(stamp_s_.least, begin_s, [&](const Vector& mid, const Vector& spread, double piece_s) {
    for (Eigen::Index i = 0; i < joint_count_; ++i) {
      const double size = std::abs(mid[i]);
      ahead.taken_J += joints_[static_cast<std::size_t>(i)].reserve_J(mid[i], spread_of(size, spread[i]), piece_s);
      left[i] = std::max(left[i], size + spread[i]);
    }
  });
  ahead.left_J = lag_can_take_J(left);
  return ahead;
}

/// What the next force may need. Nothing where not even the torque that friction holds is safe: with a deficit, while
/// the lag has left something of a torque above it.
std::optional<double> ExactLaw::spendable_J(double latency_s) const noexcept {
  const Ahead ahead = until_effect(latency_s);
  const double energy_J = energy_.value_J() - ahead.taken_J - ahead.left_J;
  if (energy_J < 0 && ahead.left_J > 0) return std::nullopt;
  return std::max(energy_J, 0.0);
}

/// The most that the lag's rest of torques of these sizes can take. Proof, A5: whatever the time constant up to lag_s.
double ExactLaw::lag_can_take_J(const Vector& left) const noexcept {
  double taken_J = 0;
  for (Eigen::Index i = 0; lag_s_ > 0 && i < joint_count_; ++i) {
    taken_J += joints_[static_cast<std::size_t>(i)].reserve_J(left[i], torque_share_ * left[i], lag_s_);
  }
  return taken_J;
}

/// The sum over the stages of the release (proof, A7), for a torque given by its sizes. Proof, A5: each may be larger
/// by torque_share, and go on for the lag.
double ExactLaw::needed_J(const Vector& torque) const noexcept {
  const double full_s = paid_.full_s.most + lag_s_;
  const double part_s = paid_.part_s.most - paid_.full_s.most;
  double needed_J = 0;
  for (Eigen::Index i = 0; i < joint_count_; ++i) {
    const LeastEnergy& joint = joints_[static_cast<std::size_t>(i)];
    const double size = std::abs(torque[i]);
    needed_J += joint.reserve_J(size, torque_share_ * size, full_s);
    if (part_s > 0) needed_J += joint.reserve_J(paid_.share * size, torque_share_ * paid_.share * size, part_s);
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
  const auto spendable = spendable_J(latency_s_max_);
  double scale = spendable ? std::min(largest, largest_scale(jacobian_.transpose() * direction, *spendable)) : 0.0;
  if (memory_ == EnergyMemory::capped) {
    const double share = std::min(scale / largest, shown_share_ + spending_.rise_per_s * std::max(0.0, interval_s_));
    if (share < scale / largest) scale = share * largest;
    shown_share_ = share;
  }
  return scale == largest ? request_N : Vector(direction * scale);
}

/// The largest s with sum_i sum_stages max(share_k s |t_i| - c_i, 0)^2 t_k/(4 b_i) <= energy: a parabola for each joint
/// and stage, from where its friction is overcome on.
double ExactLaw::largest_scale(const Vector& torque, double energy_J) const noexcept {
  struct Parabola {
    double begin = 0;
    double weight = 0;
  };
  std::array<Parabola, 2 * kJointsMax> parabolas;  // sorted by where they begin
  auto end = parabolas.begin();
  const auto add = [&](const Parabola& parabola) {
    auto place = end++;
    for (; place != parabolas.begin() && parabola.begin < (place - 1)->begin; --place) *place = *(place - 1);
    *place = parabola;
  };
  const double full_s = paid_.full_s.most + lag_s_;
  const double part_s = paid_.part_s.most - paid_.full_s.most;
  for (Eigen::Index i = 0; i < joint_count_; ++i) {
    const LeastEnergy& joint = joints_[static_cast<std::size_t>(i)];
    const double size = std::abs(torque[i]) * (1 + torque_share_);
    if (!(size > 0)) continue;
    add({joint.friction() / size, size * size * full_s / (4 * joint.damping())});
    const double part = paid_.share * size;
    if (part > 0) add({joint.friction() / part, part * part * part_s / (4 * joint.damping())});
  }
  // With t = s - begin:  a t^2 + 2 b t = room,  moved on from parabola to parabola.
  double a = 0;
  double b = 0;
  double room = energy_J;
  for (auto newest = parabolas.begin(); newest != end; ++newest) {
    const double ahead = newest == parabolas.begin() ? 0 : newest->begin - (newest - 1)->begin;
    room -= (a * ahead + 2 * b) * ahead;
    b += a * ahead;
    a += newest->weight;
    // Roots before the product: a * room underflows where little is left, and nothing would then bound the force.
    const double root = std::hypot(b, std::sqrt(a) * std::sqrt(std::max(room, 0.0)));
    const double scale = newest->begin + (room > 0 ? room / (b + root) : 0.0);
    if (newest + 1 == end || scale <= (newest + 1)->begin) return scale;
  }
  return std::numeric_limits<double>::infinity();
}

bool ExactLaw::allows(const Vector& force_N, double latency_s) const noexcept {
  constexpr double kForceRounding = 1e-12;
  if (force_N.isZero(0)) return true;
  if (!located_) return false;
  const Vector torque = jacobian_.transpose() * force_N * (1 - kForceRounding);
  const auto spendable = spendable_J(latency_s);
  return spendable && needed_J(torque) <= *spendable;
}

void ExactLaw::commit(const Vector& force_N) noexcept { committed_ = jacobian_.transpose() * force_N; }

bool ExactLaw::knots_merged() const noexcept {
  return std::any_of(joints_.begin(), joints_.end(), [](const LeastEnergy& joint) { return joint.merged(); });
}

}  // namespace forcebound::control
