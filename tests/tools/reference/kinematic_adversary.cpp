#include "tests/tools/reference/kinematic_adversary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <utility>
#include <vector>

namespace forcebound::test {
namespace {

using control::Bracket;
using control::Damping;
using control::Matrix;
using control::Motion;
using control::Vector;
using Real = long double;

constexpr double kNever = std::numeric_limits<double>::infinity();

class Opponent {
 public:
  explicit Opponent(const KinematicGame& game)
      : random_(game.seed),
        game_(game),
        facts_(game.facts),
        dof_(facts_.damping.rows()),
        reported_damping_(Damping::from_matrix(facts_.damping)),
        damping_((1 - game.truth.damping_share) * facts_.damping),
        friction_((1 - game.truth.friction_share) * facts_.friction),
        draining_(sometimes(0.5)),
        drained_share_(sometimes(0.5) ? 0.02 : number(0.02, 0.9)),
        clock_rate_(1 + game.truth.clock_share * (sometimes(0.5) ? 1 : number(-1, 1))),
        gain_(drawn_gain()),
        offset_s_(drawn_offset_s()),
        joint_(Vector::Zero(dof_)),
        offset_(Vector::Zero(dof_)),
        command_(Vector::Zero(dof_)),
        torque_(Vector::Zero(dof_)) {
    if (!game.truth.losses_with_gain) return;
    // Of a coupled damping what lies in the joints alone grows by the gains, or more.
    const Vector root = gain_.cwiseSqrt();
    damping_ = Matrix(root.asDiagonal() * damping_ * root.asDiagonal());
    friction_ = friction_.cwiseProduct(gain_);
  }

  KinematicOutcome play(control::PassivityLaw& law) {
    tick(law, 0);
    for (int n = 1; n < game_.ticks; ++n) {
      plan(law);
      const double stamp_off_s = within(game_.truth.stamp_s);
      // Neither the instant of the stamp nor of the latch runs backwards, and nobody reads before the last command.
      const double due_s = std::max(latched_s_, stamped_s_) + next_interval_s();
      const double latched_s = std::max({due_s, commanded_s_, stamped_s_ + stamp_off_s + 1e-9});
      live_until(latched_s);
      tick(law, latched_s - stamp_off_s);
    }
    return {least_J_, least_surplus_J_};
  }

 private:
  struct Command {
    double effect_s = 0;
    Vector torque;
  };

  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  bool sometimes(double share) { return number(0, 1) < share; }
  double drawn_offset_s() {
    const Bracket& offset_s = game_.truth.latency_offset_s;
    return offset_s == Bracket{} ? 0 : within(offset_s);
  }
  Vector drawn_gain() {
    const control::Bracket& share = game_.truth.torque_gain_share;
    if (share == control::Bracket{}) return Vector::Ones(dof_);
    return Vector::NullaryExpr(dof_, [&](Eigen::Index) { return 1 + (sometimes(0.5) ? share.least : share.most); });
  }
  /// Mostly one of the ends.
  double within(const Bracket& bracket) {
    if (sometimes(0.7)) return sometimes(0.5) ? bracket.least : bracket.most;
    return number(bracket.least, bracket.most);
  }
  Vector any(double size) {
    return Vector::NullaryExpr(dof_, [&](Eigen::Index) { return number(-size, size); });
  }

  void tick(control::PassivityLaw& law, double stamped_s) {
    const bool lost = game_.truth.lost_readings > 0 && sometimes(game_.truth.lost_readings);
    const Motion motion = read(stamped_s);
    lost ? law.lose(motion) : law.credit(motion);
    if (stamped_s > 0) exchange_energy(law);
    least_surplus_J_ = std::min(least_surplus_J_, energy_J_ - law.energy_J());
    write(law, lost ? Vector::Zero(dof_) : chosen(law));
  }

  /// Fills the ledger for a while, then spends it, or does whatever comes. In half of the games it fills only what the
  /// largest force needs and then spends that, always by the motion that leaves the law the least room for caution: no
  /// law forgets any of it, so that what each turn gains by an untrue fact adds up.
  void plan(const control::PassivityLaw& law) {
    if (draining_) {
      const double b = facts_.damping(0, 0);
      const double full_J = facts_.force_N_max * facts_.force_N_max * facts_.hold_s_max / (4 * b);
      phase_ = law.energy_J() < drained_share_ * full_J ? Phase::pump : Phase::spend;
      const double missing_J = std::max(full_J - law.energy_J(), 0.0);
      pump_m_per_s_ = std::sqrt(missing_J / (b * facts_.period_s));
      if (request_.size() == 0) request_ = any(1);
      return;
    }
    if (left_ > 0) {
      --left_;
      return;
    }
    phase_ = static_cast<Phase>(std::uniform_int_distribution<int>(0, 3)(random_));
    left_ = std::uniform_int_distribution<int>(1, phase_ == Phase::mixed ? 60 : 6)(random_);
    const double cap_J = 2 * facts_.force_N_max * facts_.force_N_max * facts_.hold_s_max / (4 * damping_(0, 0));
    pump_m_per_s_ = std::sqrt(cap_J / (damping_(0, 0) * facts_.period_s)) * std::pow(10, number(-3, 0.3));
    request_ = any(1) * std::pow(10, number(-2, 3));
  }

  double next_interval_s() {
    if (!game_.late_ticks) return facts_.period_s;
    if (phase_ == Phase::spend && sometimes(0.5)) return facts_.hold_s_max + facts_.latency_s + 1e-4;
    if (sometimes(0.8)) return facts_.period_s;
    return sometimes(0.1) ? number(0.15, 1) * facts_.period_s : number(1, 6) * facts_.period_s;
  }

  /// The motion since the reading before, as the clock and the encoders tell of it.
  Motion read(double stamped_s) {
    Motion motion;
    motion.interval_s = begun_ ? (stamped_s - stamped_s_) * clock_rate_ : 0;
    motion.latency_s = reported_latency_s_;
    report_times(motion);
    motion.latency_s_max = facts_.latency_s + kChoosing_s;
    motion.write_failed = failed_ && game_.truth.failures_reported;
    if (game_.truth.impossible_intervals > 0) report_the_impossible(motion);
    begun_ = true;
    stamped_s_ = stamped_s;
    latched_s_ = now_s_;
    read_ = joint_;
    motion.joint = joint_;
    for (Eigen::Index i = 0; i < dof_; ++i) {
      const double step = facts_.encoder_step[i];
      if (step == 0) continue;
      if (sometimes(game_.truth.lost_counts)) offset_[i] += sometimes(0.5) ? step : -step;
      const double off = game_.truth.encoder_steps * (sometimes(0.5) ? (sometimes(0.5) ? 1 : -1) : number(-1, 1));
      motion.joint[i] = step * std::round(joint_[i] / step + off) + offset_[i];
    }
    motion.position = motion.joint;
    motion.jacobian = Matrix::Identity(dof_, dof_);
    if (game_.turning) {
      motion.jacobian = Matrix::NullaryExpr(dof_, dof_, [&](Eigen::Index, Eigen::Index) { return number(-1, 1); });
      if (sometimes(0.1)) motion.jacobian.col(0).setZero();
    }
    jacobian_ = motion.jacobian;
    motion.damping = &reported_damping_;
    return motion;
  }

  /// Of the last command, when it took effect and when its release began, as far as the device tells. A report's stamp
  /// is as far off as a reading's.
  void report_times(Motion& motion) {
    if (failed_ || !commands_.empty()) return;
    const auto shown_s = [&](double true_s) {
      return (true_s - within(game_.truth.stamp_s) - stamped_s_) * clock_rate_;
    };
    if (game_.truth.effects_reported && effect_s_ >= 0) motion.effect_s = shown_s(effect_s_);
    if (game_.truth.releases_reported && release_s_) motion.held_s = shown_s(*release_s_) - motion.latency_s;
  }

  /// A stamp that is wrong spoils the interval before it and the one after it, which may be any.
  void report_the_impossible(Motion& motion) {
    if (spoilt_) {
      motion.interval_s =
          sometimes(0.5) ? motion.interval_s + 2e-3 * number(0, 1) : motion.interval_s * std::pow(10, number(-3, 0));
    }
    spoilt_ = begun_ && sometimes(game_.truth.impossible_intervals);
    if (spoilt_) motion.interval_s = sometimes(0.5) ? -1e-3 : (sometimes(0.5) ? 0 : std::nan(""));
  }

  Vector chosen(control::PassivityLaw& law) {
    if (phase_ == Phase::mixed) {
      if (sometimes(0.2)) request_ = any(1) * std::pow(10, number(-2, 3));
      if (sometimes(0.3)) request_ = -request_;
    }
    Vector request = request_.size() > 0 ? request_ : any(10);
    if (phase_ == Phase::pump) request.setZero();
    if (phase_ == Phase::spend) request *= facts_.force_N_max / std::max(request.norm(), 1e-12);
    const double size = request.norm();
    return law.bound(size > facts_.force_N_max ? Vector(request * (facts_.force_N_max / size)) : request);
  }

  void write(control::PassivityLaw& law, Vector force) {
    // Chosen, it takes a while until it is written; the law is asked again, as ForceBounder does.
    const double took_s = game_.late_ticks && sometimes(0.5) ? number(0, 1.2) * kChoosing_s : 0;
    const double written_s = std::max(stamped_s_ + took_s / clock_rate_, latched_s_);
    reported_latency_s_ = (written_s - stamped_s_) * clock_rate_ + facts_.latency_s;
    if (!law.allows(force, reported_latency_s_)) force.setZero();
    law.commit(force);
    commanded_s_ = written_s;
    failed_ = sometimes(game_.truth.failed_writes);
    if (failed_) return;
    double effect_s = written_s + facts_.latency_s + offset_s_ + within(game_.truth.latency_s);
    if (!commands_.empty()) effect_s = std::max(effect_s, commands_.back().effect_s);
    commands_.push_back({effect_s, jacobian_.transpose() * force});
  }

  /// What a law gives up is no longer its own to spend; what it receives is.
  void exchange_energy(control::PassivityLaw& law) {
    const double given_J = law.energy_given_J();
    const double received_J = sometimes(0.1) ? number(0, 20 * game_.received_J_per_tick) : 0;
    law.receive_energy(received_J);
    energy_J_ += Real{received_J} - (given_J - std::exchange(given_J_, given_J));
    least_J_ = std::min(least_J_, energy_J_);
  }

  void live_until(double end_s) {
    while (now_s_ < end_s) {
      double next_s = std::min({end_s, full_until_s_, part_until_s_});
      if (!commands_.empty()) next_s = std::min(next_s, commands_.front().effect_s);
      const double lag_s = game_.truth.actuator_lag_s;
      if (lag_s > 0) next_s = std::min(next_s, now_s_ + lag_s / 6);
      if (next_s > now_s_) {
        follow(next_s - now_s_);
        move(next_s - now_s_, next_s == end_s);
        now_s_ = next_s;
      }
      let_go();
      if (!commands_.empty() && commands_.front().effect_s <= now_s_) apply_command();
    }
  }

  /// The torque as it is at the end of the step, all through the step: not slower than the lag.
  void follow(double duration_s) {
    const double lag_s = game_.truth.actuator_lag_s;
    const double left = lag_s > 0 ? std::exp(-duration_s / lag_s) : 0;
    torque_ = command_ + left * (torque_ - command_);
  }

  void let_go() {
    if (full_until_s_ <= now_s_) {
      release_s_ = full_until_s_;
      command_ *= facts_.release_s > 0 ? facts_.release_share : 0;
      full_until_s_ = kNever;
    }
    if (part_until_s_ <= now_s_) {
      command_.setZero();
      part_until_s_ = kNever;
    }
  }

  void apply_command() {
    command_ = gain_.cwiseProduct(commands_.front().torque);
    effect_s_ = commands_.front().effect_s;
    commands_.erase(commands_.begin());
    release_s_.reset();
    full_until_s_ = part_until_s_ = kNever;
    if (!facts_.releases) return;
    const double early_s = game_.truth.early_release_share * facts_.hold_s_max * number(0, 1);
    full_until_s_ = effect_s_ + facts_.hold_s_max + within(game_.truth.hold_s) - early_s;
    part_until_s_ = std::max(full_until_s_,
                             effect_s_ + facts_.hold_s_max + facts_.release_s + within(game_.truth.hold_s) - early_s);
    if (facts_.release_s == 0) part_until_s_ = full_until_s_;
  }

  void move(double duration_s, bool to_next_reading) {
    Vector way(dof_);
    Real change_J = 0;
    const bool still = sometimes(0.1);
    for (Eigen::Index i = 0; i < dof_; ++i) {
      const double b = damping_(i, i);
      const double most = std::abs(torque_[i]) * (1 + game_.truth.torque_ripple_share);
      const double surplus = std::max(most - friction_[i], 0.0);
      way[i] = std::copysign(surplus, torque_[i]) * duration_s / (2 * b);  // takes the most
      if (draining_) {
        // Whatever the torque, the same slope of the energy over the place: so the least energy is attained.
        if (phase_ == Phase::pump && i == 0) way[i] = pump_m_per_s_ * duration_s + torque_[i] * duration_s / (2 * b);
        if (i == 0 && to_next_reading) way[i] = phase_ == Phase::pump ? to_edge_behind(way[i]) : to_edge_ahead(way[i]);
        continue;
      }
      if (still && sometimes(0.5)) way[i] = 0;
      if (phase_ == Phase::pump && (i == 0 || sometimes(0.5))) way[i] = pump_m_per_s_ * duration_s;
      if (phase_ == Phase::mixed || phase_ == Phase::creep) {
        if (sometimes(0.15)) way[i] *= number(-1, 3);
        // Let go of: back to where the reading was, as if nothing had been taken.
        if (surplus == 0 && sometimes(0.5)) way[i] = read_[i] - joint_[i];
        if (sometimes(phase_ == Phase::creep ? 0.5 : 0.1)) way[i] = flicker(i);
        if (sometimes(0.05)) way[i] = number(-1e-4, 1e-4);
      }
    }
    for (Eigen::Index i = 0; i < dof_; ++i) {
      const Real way_m = way[i];
      for (Eigen::Index j = 0; j < dof_; ++j) change_J += way_m * damping_(i, j) * Real{way[j]} / Real{duration_s};
      const Real work_J = Real{torque_[i]} * way_m;
      change_J += Real{friction_[i]} * std::fabs(way_m) - work_J;
      change_J -= Real{game_.truth.torque_ripple_share} * std::fabs(work_J);
    }
    joint_ += way;
    energy_J_ += change_J;
    least_J_ = std::min(least_J_, energy_J_);
  }

  /// Just over the nearest edge between two counts: the shortest way to what reads as a whole step.
  double flicker(Eigen::Index i) {
    const double step = facts_.encoder_step[i];
    if (step == 0) return 0;
    const double edge = (std::floor(joint_[i] / step) + 0.5) * step;
    return edge - joint_[i] + (sometimes(0.5) ? 1e-9 : -1e-9);
  }

  /// The way of the first joint, shortened to just beyond the last edge between two counts on it: the nearest place
  /// with that reading.
  double to_edge_behind(double way) const {
    const double step = facts_.encoder_step[0];
    if (step == 0 || way < step) return way;
    return (std::floor((joint_[0] + way) / step - 0.5) + 0.5) * step + kBeyond_m - joint_[0];
  }

  /// To just before the nearest edge: from there the next motion forward is the shortest for its reading.
  double to_edge_ahead(double way) const {
    const double step = facts_.encoder_step[0];
    if (step == 0) return way;
    return (std::round((joint_[0] + way) / step - 0.5) + 0.5) * step - kBeyond_m - joint_[0];
  }

  enum class Phase { pump, spend, creep, mixed };

  std::mt19937_64 random_;
  const KinematicGame& game_;
  const control::DeviceFacts& facts_;
  Eigen::Index dof_;
  Damping reported_damping_;
  Matrix damping_;
  Vector friction_;
  bool draining_;
  double drained_share_;  ///< with less than that of what the largest force needs, it fills again
  double clock_rate_;     ///< seconds of the clock for a true one
  static constexpr double kChoosing_s = 30e-6;
  static constexpr double kBeyond_m = 1e-9;

  Phase phase_ = Phase::mixed;
  int left_ = 0;
  double pump_m_per_s_ = 0;
  Vector request_;

  // All times are true, since the beginning.
  double now_s_ = 0;
  double latched_s_ = 0;
  double stamped_s_ = 0;  ///< when the clock showed the reading's stamp
  double commanded_s_ = 0;
  double effect_s_ = -1;
  double full_until_s_ = kNever;
  double part_until_s_ = kNever;
  std::optional<double> release_s_;  ///< when the release of the force in effect began
  bool begun_ = false;
  bool failed_ = false;
  bool spoilt_ = false;
  double reported_latency_s_ = 0;

  Vector gain_;      ///< what a motor makes of a command is so many times that
  double offset_s_;  ///< of the latency
  Vector joint_;
  Vector read_;    ///< where it was at the reading
  Vector offset_;  ///< counts that were lost
  Matrix jacobian_;
  std::vector<Command> commands_;
  Vector command_;  ///< in effect
  Vector torque_;   ///< of the motors
  Real energy_J_ = 0;
  double given_J_ = 0;
  Real least_J_ = 0;
  Real least_surplus_J_ = 0;
};

}  // namespace

KinematicOutcome play(control::PassivityLaw& law, const KinematicGame& game) { return Opponent(game).play(law); }

control::Uncertainty uncertainty_of(const DeviceTruth& truth, const control::DeviceFacts& facts) {
  return {.stamp_s = truth.stamp_s,
          .latency_s = truth.latency_s,
          .latency_offset_s = truth.latency_offset_s,
          .hold_s = {truth.hold_s.least - truth.early_release_share * facts.hold_s_max, truth.hold_s.most},
          .clock_share = truth.clock_share,
          .encoder_steps = truth.encoder_steps,
          .damping_share = truth.damping_share,
          .friction_share = truth.friction_share,
          .torque_gain_share = truth.torque_gain_share,
          .losses_with_gain = truth.losses_with_gain,
          .torque_ripple_share = truth.torque_ripple_share,
          .actuator_lag_s = truth.actuator_lag_s};
}

}  // namespace forcebound::test
