#include "tests/tools/sim/simulated_leader.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace forcebound::sim {
namespace {

using control::LeaderFacts;
using control::LeaderJoint;
using control::Vector;

template <class Value>
Vector of_joints(const LeaderFacts& facts, Value&& value) {
  return Vector::NullaryExpr(static_cast<Eigen::Index>(facts.joints.size()),
                             [&](Eigen::Index i) { return value(facts.joints[static_cast<std::size_t>(i)]); });
}

device::DeviceDescription description_of(const LeaderFacts& facts, const Vector& inertia_kg_m2) {
  const std::size_t most = control::kDofMax;
  if (facts.joints.empty() || facts.joints.size() > most) {
    throw std::invalid_argument("a simulated leader has 1 to 6 joints, got " + std::to_string(facts.joints.size()));
  }
  if (inertia_kg_m2.rows() != static_cast<Eigen::Index>(facts.joints.size()) || !(inertia_kg_m2.array() > 0).all() ||
      !inertia_kg_m2.allFinite()) {
    throw std::invalid_argument("a simulated leader: inertia_kg_m2 must be > 0 for each of " +
                                std::to_string(facts.joints.size()) + " joints");
  }
  device::DeviceDescription arm;
  control::DeviceFacts& of_arm = arm.facts;
  of_arm.name = "leader";
  of_arm.period_s = facts.period_s;
  of_arm.damping = of_joints(facts, [](const LeaderJoint& j) { return j.damping_N_m_s_per_rad; }).asDiagonal();
  of_arm.friction = of_joints(facts, [](const LeaderJoint& j) { return j.friction_N_m; });
  of_arm.encoder_step = of_arm.actuator_step = Vector::Zero(inertia_kg_m2.rows());
  of_arm.force_N_max = std::numeric_limits<double>::infinity();
  of_arm.hold_s_max = facts.hold_s_max;
  of_arm.releases = facts.watchdog_s_least > 0;
  arm.inertia = inertia_kg_m2.asDiagonal();
  return arm;
}

device::DeviceFlaws flaws_of(const LeaderFacts& facts, std::uint64_t seed) {
  double gain = 0;
  double ripple = 0;
  for (const LeaderJoint& joint : facts.joints) {
    gain = std::max(gain, joint.torque_gain_share);
    ripple = std::max(ripple, joint.torque_ripple_share);
  }
  return {.seed = seed,
          .latency_s = {0, facts.latency_s_max - facts.read_s_max},
          .hold_s = {facts.watchdog_s_least > 0 ? facts.watchdog_s_least - facts.hold_s_max : 0, 0},
          .torque_gain_share = {-gain, gain},
          .torque_ripple_share = ripple};
}

/// Gain and ripple are one for all joints here.
const LeaderFacts& with_one_gain(const LeaderFacts& facts) {
  for (const LeaderJoint& joint : facts.joints) {
    if (joint.torque_gain_share != facts.joints.front().torque_gain_share ||
        joint.torque_ripple_share != facts.joints.front().torque_ripple_share) {
      throw std::invalid_argument(
          "a simulated leader has one torque_gain_share and one torque_ripple_share for all "
          "joints, '" +
          joint.name + "' has another than '" + facts.joints.front().name + "'");
    }
  }
  return facts;
}

}  // namespace

SimulatedLeader::SimulatedLeader(const LeaderFacts& facts, const Vector& inertia_kg_m2,
                                 std::unique_ptr<const device::Operator> hand, std::uint64_t seed)
    : facts_(facts),
      device_(description_of(facts, inertia_kg_m2), std::move(hand), flaws_of(with_one_gain(facts), seed)),
      random_(seed),
      behind_play_(device_.truth().joint) {}

Vector SimulatedLeader::read(Nanoseconds stamp) {
  constexpr double kAtAnEnd = 0.7;
  std::uniform_real_distribution<double> number(0, 1);
  const double drawn = number(random_);
  const double share = number(random_) < kAtAnEnd ? std::round(drawn) : drawn;
  (void)device_.read(stamp + time::from_seconds(share * facts_.read_s_max));
  const Vector motor = device_.truth().joint;
  Vector read(motor.rows());
  for (Eigen::Index i = 0; i < motor.rows(); ++i) {
    const LeaderJoint& joint = facts_.joints[static_cast<std::size_t>(i)];
    behind_play_[i] = std::clamp(behind_play_[i], motor[i] - joint.backlash_rad / 2, motor[i] + joint.backlash_rad / 2);
    read[i] = joint.encoder_step_rad * std::round(behind_play_[i] / joint.encoder_step_rad);
  }
  return read;
}

}  // namespace forcebound::sim
