#include "forcebound/control/force_bounded_leader.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/control/exact_law.hpp"

namespace forcebound::control {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

template <class Value>
[[noreturn]] void refuse_leader(const std::string& where, const char* what, const Value& got) {
  throw std::invalid_argument(joined("leader: ", where, what, ", got ", got));
}

/// A number of a joint, or of the loop where `where` is empty.
struct Checked {
  std::string where{};
  void positive(const char* what, double value) const {
    if (!(value > 0) || !std::isfinite(value)) refuse_leader(where, what, value);
  }
  void not_negative(const char* what, double value) const {
    if (!(value >= 0) || !std::isfinite(value)) refuse_leader(where, what, value);
  }
  void share(const char* what, double value) const {
    if (!(value >= 0 && value < 1)) refuse_leader(where, what, value);
  }
};

void check_joint(const LeaderJoint& joint, const std::string& where) {
  const Checked is{where};
  is.positive("damping_N_m_s_per_rad must be > 0", joint.damping_N_m_s_per_rad);
  is.not_negative("friction_N_m must be >= 0", joint.friction_N_m);
  is.positive("encoder_step_rad must be > 0", joint.encoder_step_rad);
  is.not_negative("backlash_rad must be >= 0", joint.backlash_rad);
  is.positive("torque_N_m_max must be > 0", joint.torque_N_m_max);
  is.not_negative("torque_step_N_m must be >= 0", joint.torque_step_N_m);
  is.share("torque_gain_share must be >= 0 and < 1", joint.torque_gain_share);
  is.share("torque_ripple_share must be >= 0 and < 1", joint.torque_ripple_share);
  is.not_negative("speed_rad_per_s_max must be >= 0", joint.speed_rad_per_s_max);
  is.not_negative("goal_stiffness_N_m_per_rad must be >= 0", joint.goal_stiffness_N_m_per_rad);
  if (!(joint.goal_rad_least < joint.goal_rad_most)) {
    refuse_leader(where, "goal_rad_least must be below goal_rad_most",
                  joined(joint.goal_rad_least, " and ", joint.goal_rad_most));
  }
}

void check_loop(LeaderFacts& facts) {
  const Checked is{};
  if (facts.joints.empty()) refuse_leader({}, "there must be a joint or more", 0);
  if (!(facts.period_s >= 1e-4 && facts.period_s <= 0.1)) {
    refuse_leader({}, "period_s must be 0.0001 to 0.1", facts.period_s);
  }
  is.not_negative("read_s_max must be >= 0", facts.read_s_max);
  if (!(facts.latency_s_max >= facts.read_s_max && facts.latency_s_max <= 0.1)) {
    refuse_leader({}, "latency_s_max must be at least read_s_max and at most 0.1", facts.latency_s_max);
  }
  is.not_negative("hold_s_max must be >= 0", facts.hold_s_max);
  if (facts.hold_s_max == 0) facts.hold_s_max = 2 * facts.period_s + facts.latency_s_max;
  if (facts.hold_s_max < facts.period_s + facts.latency_s_max || facts.hold_s_max > 1) {
    refuse_leader({}, "hold_s_max must be at least period_s and latency_s_max together, and at most 1",
                  facts.hold_s_max);
  }
  if (!(facts.watchdog_s_least >= 0 && facts.watchdog_s_least <= facts.hold_s_max)) {
    refuse_leader({}, "watchdog_s_least must be 0 to hold_s_max", facts.watchdog_s_least);
  }
  is.share("clock_share must be >= 0 and < 1", facts.clock_share);
  is.positive("memory_J must be > 0", facts.memory_J);
}

/// The friction that is left for the law, of a servo that takes goals.
double friction_beside_goals(const LeaderJoint& joint, const LeaderFacts& facts, const std::string& where) {
  if (joint.goal_stiffness_N_m_per_rad == 0) return joint.friction_N_m;
  if (joint.torque_ripple_share > 0) {
    refuse_leader(where, "torque_ripple_share must be 0 for goals, as a spring of changing stiffness gives energy",
                  joint.torque_ripple_share);
  }
  if (joint.speed_rad_per_s_max == 0 && facts.latency_s_max > 0) {
    refuse_leader(where, "speed_rad_per_s_max must be > 0 for goals, as they are behind by speed times latency", 0);
  }
  // Half a step and half the play are of the reading, the other halves of what the servo itself reads meanwhile.
  const double behind_rad = joint.encoder_step_rad + joint.backlash_rad +
                            joint.speed_rad_per_s_max / (1 - facts.clock_share) * facts.latency_s_max;
  const double most = joint.friction_N_m / ((1 + joint.torque_gain_share) * behind_rad);
  if (joint.goal_stiffness_N_m_per_rad > most) {
    refuse_leader(
        where,
        joined("goal_stiffness_N_m_per_rad must be at most ", most, ", so that friction holds what a goal is ",
               "behind the joint, ", behind_rad, " rad: use a smaller gain, or torques")
            .c_str(),
        joint.goal_stiffness_N_m_per_rad);
  }
  return joint.friction_N_m * std::max(0.0, 1 - joint.goal_stiffness_N_m_per_rad / most);
}

DeviceFacts facts_of(const LeaderJoint& joint, const LeaderFacts& loop, const std::string& where) {
  const auto one = [](double value) { return Vector::Constant(1, value); };
  DeviceFacts facts;
  facts.name = joint.name;
  facts.period_s = loop.period_s;
  facts.damping = Matrix::Constant(1, 1, joint.damping_N_m_s_per_rad);
  facts.friction = one(friction_beside_goals(joint, loop, where));
  facts.encoder_step = one(joint.encoder_step_rad);
  facts.actuator_step =
      one(joint.goal_stiffness_N_m_per_rad > 0 ? joint.goal_stiffness_N_m_per_rad * joint.encoder_step_rad
                                               : joint.torque_step_N_m);
  facts.force_N_max = joint.torque_N_m_max;
  facts.hold_s_max = loop.hold_s_max;
  facts.releases = loop.watchdog_s_least > 0;
  if (joint.speed_rad_per_s_max > 0) facts.speed_max = one(joint.speed_rad_per_s_max);
  facts.uncertainty.stamp_s = {0, loop.read_s_max};
  facts.uncertainty.latency_s = {0, loop.latency_s_max};
  if (facts.releases) facts.uncertainty.hold_s = {loop.watchdog_s_least - loop.hold_s_max, 0};
  facts.uncertainty.clock_share = loop.clock_share;
  facts.uncertainty.encoder_steps = joint.backlash_rad / 2 / joint.encoder_step_rad;
  facts.uncertainty.torque_gain_share = {-joint.torque_gain_share, joint.torque_gain_share};
  facts.uncertainty.torque_ripple_share = joint.torque_ripple_share;
  return facts;
}

Motion motion_of_a_joint() {
  Motion motion;
  motion.position = motion.joint = Vector::Zero(1);
  motion.jacobian = Matrix::Identity(1, 1);
  return motion;
}

}  // namespace

ForceBoundedLeader::ForceBoundedLeader(LeaderFacts facts) : facts_(std::move(facts)) {
  // Behind a network a joint needs what it saved in seconds, however little the largest torque takes in a step.
  constexpr double kNoLimit = 1e9;
  check_loop(facts_);
  joints_.reserve(facts_.joints.size());
  for (std::size_t i = 0; i < facts_.joints.size(); ++i) {
    LeaderJoint& joint = facts_.joints[i];
    if (joint.name.empty()) joint.name = joined(i + 1);
    const std::string where = "joint '" + joint.name + "': ";
    check_joint(joint, where);
    const DeviceFacts of_joint = facts_of(joint, facts_, where);
    const Spending spending{.memory_reserves = kNoLimit, .memory_J_max = facts_.memory_J};
    joints_.push_back(
        {.bounder = ForceBounder(of_joint, std::make_unique<ExactLaw>(of_joint, EnergyMemory::capped, spending)),
         .motion = motion_of_a_joint()});
  }
}

void ForceBoundedLeader::store_fault(Fault fault, std::size_t joint) noexcept {
  if (fault_ != Fault::none) return;
  fault_ = fault;
  faulty_joint_ = joint;
}

void ForceBoundedLeader::begin_step(double interval_s) noexcept {
  fault_ = Fault::none;
  const double passed_s = begun_ ? interval_s : 0;
  if (begun_ && !is_measurable(passed_s)) store_fault(Fault::interval_impossible, 0);
  if (facts_.watchdog_s_least == 0 && passed_s + facts_.latency_s_max > facts_.hold_s_max) {
    ++late_;
    store_fault(Fault::late, 0);
  }
  begun_ = true;
  for (Joint& joint : joints_) joint.motion.interval_s = passed_s;
}

double ForceBoundedLeader::step_joint(std::size_t i, double position_rad, const double* feedback_N_m) noexcept {
  const LeaderJoint& facts = facts_.joints[i];
  Joint& joint = joints_[i];
  const double k = facts.goal_stiffness_N_m_per_rad;
  // Out of the range of its goals none makes zero torque: there the reading is as good as lost.
  const bool usable = k == 0 || (position_rad >= facts.goal_rad_least && position_rad <= facts.goal_rad_most);
  joint.motion.position[0] = joint.motion.joint[0] = usable ? position_rad : kNoNumber;
  joint.motion.write_failed = std::exchange(joint.write_failed, false);
  const ForceBounder::Counts before = joint.bounder.counts();
  double torque_N_m = 0;
  if (feedback_N_m == nullptr) {
    torque_N_m = joint.bounder.release(joint.motion)[0];
  } else {
    double wanted_N_m = *feedback_N_m;
    if (k > 0 && usable) {
      wanted_N_m =
          std::clamp(wanted_N_m, k * (facts.goal_rad_least - position_rad), k * (facts.goal_rad_most - position_rad));
    }
    torque_N_m = joint.bounder.tick(joint.motion, Vector::Constant(1, wanted_N_m))[0];
  }
  const ForceBounder::Counts& now = joint.bounder.counts();
  const bool lost =
      now.readings_not_finite > before.readings_not_finite || now.readings_too_far > before.readings_too_far;
  if (lost) store_fault(Fault::reading_lost, i);
  if (now.requests_not_finite > before.requests_not_finite) store_fault(Fault::feedback_not_finite, i);
  if (k == 0) return torque_N_m;
  if (lost) {
    joint.write_failed = true;  // the goal stays where it was
  } else {
    joint.goal_rad = position_rad + torque_N_m / k;
  }
  return torque_N_m;
}

void ForceBoundedLeader::step(std::span<const double> position_rad, std::span<const double> feedback_N_m,
                              double interval_s, std::span<double> torque_N_m) noexcept {
  begin_step(interval_s);
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    torque_N_m[i] = step_joint(i, position_rad[i], feedback_N_m.empty() ? nullptr : &feedback_N_m[i]);
  }
}

void ForceBoundedLeader::lose(double interval_s) noexcept {
  begin_step(interval_s);
  for (std::size_t i = 0; i < joints_.size(); ++i) (void)step_joint(i, kNoNumber, nullptr);
}

void ForceBoundedLeader::report_failed_write() noexcept {
  ++writes_failed_;
  for (Joint& joint : joints_) joint.write_failed = true;
}

ForceBoundedLeader::Counts ForceBoundedLeader::counts() const noexcept {
  Counts sum{.intervals_impossible = joints_.front().bounder.counts().intervals_impossible,
             .late = late_,
             .writes_failed = writes_failed_};
  for (const Joint& joint : joints_) {
    const ForceBounder::Counts& counts = joint.bounder.counts();
    sum.readings_lost += counts.readings_not_finite + counts.readings_too_far;
    sum.feedback_not_finite += counts.requests_not_finite;
    sum.saturated += counts.saturated;
  }
  return sum;
}

std::string ForceBoundedLeader::fault_in_words() const {
  const std::string joint = "joint '" + facts_.joints[faulty_joint_].name + "': ";
  switch (fault_) {
    case Fault::interval_impossible:
      return "the interval is none that a clock can have measured: torques are zero until those before are over";
    case Fault::reading_lost:
      return joint + "reading lost: not a number, or further than the joint can be so soon; its torque is zero";
    case Fault::feedback_not_finite:
      return joint + "feedback is not a number; its torque is zero";
    case Fault::late:
      return joined("step later than hold_s_max, ", facts_.hold_s_max,
                    " s, with the latency: not passive, and no more torque until that is earned again");
    case Fault::none:
      break;
  }
  return {};
}

}  // namespace forcebound::control
