#include "forcebound/server/robot/robot_description.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>
#include <stdexcept>

#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::server {
namespace {

constexpr double kLatencyMost_s = 0.01;
constexpr double kMost = 1e6;

/// Checks of the numbers that a driver tells.
class CheckedRobot {
 public:
  CheckedRobot(const forcebound_robot& told, const std::string& driver) : robot_(told), driver_(driver) {}

  [[noreturn]] void refuse(const std::string& what, const std::string& accepted, double got) const {
    throw std::runtime_error("driver '" + driver_ + "': its robot's " + what + " must be " + accepted + ", got " +
                             text::to_text(got));
  }
  double within(const std::string& what, double value, double least, double most) const {
    if (value >= least && value <= most) return value;
    refuse(what, "from " + text::to_text(least) + " to " + text::to_text(most), value);
  }
  double positive(const std::string& what, double value) const {
    if (value > 0 && value <= kMost) return value;
    refuse(what, "> 0", value);
  }
  /// A row for each joint.
  template <class Check>
  Vector rows(const std::string& what, const double* values, const Check& check) const {
    Vector rows(robot_.joints);
    for (int i = 0; i < robot_.joints; ++i) rows[i] = check(of_joint(what, i), values[i]);
    return rows;
  }
  Vector positive_rows(const std::string& what, const double* values) const {
    return rows(what, values, [this](const std::string& name, double value) { return positive(name, value); });
  }
  Vector not_negative_rows(const std::string& what, const double* values) const {
    return rows(what, values, [this](const std::string& name, double value) { return within(name, value, 0, kMost); });
  }
  Vector angles(const std::string& what, const double* values) const {
    return rows(what, values, [this](const std::string& name, double value) { return within(name, value, -100, 100); });
  }
  Eigen::Vector3d vector(const std::string& what, const double* values) const {
    for (int i = 0; i < 3; ++i) (void)within(what, values[i], -1000, 1000);
    return {values[0], values[1], values[2]};
  }
  DescribedJoint joint(int number) const {
    const auto i = static_cast<std::size_t>(number);
    DescribedJoint joint;
    joint.axis = vector(of_joint("axis", number), robot_.axis[i]);
    if (joint.axis.isZero(0)) refuse(of_joint("axis", number), "a direction", 0);
    joint.point_m = vector(of_joint("point_m", number), robot_.point_m[i]);
    joint.centre_m = vector(of_joint("centre_m", number), robot_.centre_m[i]);
    joint.mass_kg = positive(of_joint("mass_kg", number), robot_.mass_kg[i]);
    joint.rotor_kg_m2 = within(of_joint("rotor_kg_m2", number), robot_.rotor_kg_m2[i], 0, kMost);
    const double* const inertia = robot_.inertia_kg_m2[i];
    for (int k = 0; k < 6; ++k) (void)within(of_joint("inertia_kg_m2", number), inertia[k], -kMost, kMost);
    joint.inertia_kg_m2 << inertia[0], inertia[3], inertia[4], inertia[3], inertia[1], inertia[5], inertia[4],
        inertia[5], inertia[2];
    return joint;
  }

 private:
  static std::string of_joint(const std::string& what, int number) {
    return what + " of joint " + std::to_string(number + 1);
  }
  const forcebound_robot& robot_;
  const std::string& driver_;
};

control::DeviceFacts joint_facts(const forcebound_robot& told, const CheckedRobot& checks, const std::string& driver) {
  control::DeviceFacts facts;
  const std::string_view name(told.name, ::strnlen(told.name, sizeof told.name));
  facts.name = text::printable(name.empty() ? std::string_view(driver) : name);
  facts.period_s = checks.within("period_s", told.period_s, 1e-4, 0.1);
  facts.damping = checks.positive_rows("damping", told.damping).asDiagonal();
  facts.friction = checks.not_negative_rows("friction", told.friction);
  facts.encoder_step = checks.not_negative_rows("encoder_step", told.encoder_step);
  facts.actuator_step = checks.not_negative_rows("actuator_step", told.actuator_step);
  facts.hold_s_max = checks.within("hold_s_max", told.hold_s_max, facts.period_s, 1);
  facts.latency_s = checks.within("latency_s", told.latency_s, 0, kLatencyMost_s);
  facts.uncertainty.latency_s = {-facts.latency_s, 0};
  const double stamp_s = checks.within("stamp_s_most", told.stamp_s_most, 0, kLatencyMost_s);
  facts.uncertainty.stamp_s = {-stamp_s, stamp_s};
  return facts;
}

}  // namespace

std::vector<ChainLink> links_of(const std::vector<DescribedJoint>& joints) {
  std::vector<ChainLink> links;
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  for (const DescribedJoint& joint : joints) {
    ChainLink link;
    link.from_before = Eigen::Translation3d(joint.point_m - before);
    link.axis = joint.axis.normalized();
    link.mass_kg = joint.mass_kg;
    link.centre = joint.centre_m - joint.point_m;
    link.inertia = joint.inertia_kg_m2;
    link.rotor_kg_m2 = joint.rotor_kg_m2;
    links.push_back(link);
    before = joint.point_m;
  }
  return links;
}

Eigen::Isometry3d tool_of(const std::vector<DescribedJoint>& joints, const Eigen::Vector3d& tool_m,
                          const Eigen::Vector3d& tool_rad) {
  Eigen::Isometry3d tool{Eigen::Translation3d(tool_m - joints.back().point_m)};
  if (tool_rad.norm() > 0) tool.linear() = Eigen::AngleAxisd(tool_rad.norm(), tool_rad.normalized()).matrix();
  return tool;
}

std::string refusal_of(const RobotDescription& robot) {
  if (!robot.compensates_gravity && !robot.brakes) {
    return "gravity is left to the program, so the robot must have brakes, or it would fall at each stop";
  }
  const RobotLimits& limits = robot.chain.limits;
  for (Eigen::Index i = 0; i < limits.lowest.rows(); ++i) {
    const std::string joint = "joint " + std::to_string(i + 1);
    if (!(limits.lowest[i] < limits.highest[i])) return joint + ": its lowest angle must be below its highest";
    const double rest = robot.chain.rest[i];
    if (rest < limits.lowest[i] || rest > limits.highest[i]) return joint + ": its rest must be within its limits";
    const Eigen::Matrix3d& inertia = robot.chain.links[static_cast<std::size_t>(i)].inertia;
    if (inertia.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff() < 0)
      return joint + ": its link's inertia must be positive semidefinite";
  }
  const SerialChain chain(robot.chain);
  const Eigen::LLT<Matrix> mass(chain.mass_matrix(robot.chain.rest));
  return mass.info() == Eigen::Success ? "" : "its masses must make moving each joint cost energy";
}

void set_facts_from_limits(RobotDescription& robot) {
  constexpr double kFastestOfLargest = 4;
  robot.facts.force_N_max = robot.chain.limits.torque_max.norm();
  robot.facts.speed_max = kFastestOfLargest * robot.chain.limits.speed_max;
}

RobotDescription description_of(const forcebound_robot& told, const std::string& driver) {
  const CheckedRobot checks(told, driver);
  if (told.joints < 1 || told.joints > control::kJointsMax) {
    checks.refuse("joints", "from 1 to " + std::to_string(control::kJointsMax), told.joints);
  }
  RobotDescription robot{.facts = joint_facts(told, checks, driver), .chain = {}};
  robot.identified = told.identified != 0;
  robot.brakes = told.brakes != 0;
  robot.compensates_gravity = told.gravity == 0;
  robot.chain.name = robot.facts.name;
  std::vector<DescribedJoint> joints;
  joints.reserve(static_cast<std::size_t>(told.joints));
  for (int i = 0; i < told.joints; ++i) joints.push_back(checks.joint(i));
  robot.chain.links = links_of(joints);
  robot.chain.tool = tool_of(joints, checks.vector("tool_m", told.tool_m), checks.vector("tool_rad", told.tool_rad));
  robot.chain.rest = checks.angles("rest_rad", told.rest_rad);
  robot.chain.limits = {
      .lowest = checks.angles("lowest_rad", told.lowest_rad),
      .highest = checks.angles("highest_rad", told.highest_rad),
      .speed_max = checks.positive_rows("speed_max", told.speed_max),
      .torque_max = checks.positive_rows("torque_max", told.torque_max),
      .torque_rate_max = checks.not_negative_rows("torque_rate_max", told.torque_rate_max),
      .tool_speed_m_per_s_max = checks.positive("tool_speed_m_per_s_max", told.tool_speed_m_per_s_max),
      .tool_turn_rad_per_s_max = checks.positive("tool_turn_rad_per_s_max", told.tool_turn_rad_per_s_max)};
  set_facts_from_limits(robot);
  if (told.sensor_period_s != 0) {
    robot.sensor = {.period = time::from_seconds(checks.within("sensor_period_s", told.sensor_period_s, 1e-5, 0.1)),
                    .noise_N_sd = checks.within("sensor_N_sd", told.sensor_N_sd, 0, kMost),
                    .noise_N_m_sd = checks.within("sensor_N_m_sd", told.sensor_N_m_sd, 0, kMost),
                    .bias_N_max = checks.within("sensor_bias_N_max", told.sensor_bias_N_max, 0, kMost),
                    .bias_N_m_max = checks.within("sensor_bias_N_m_max", told.sensor_bias_N_m_max, 0, kMost)};
  }
  const std::string refusal = refusal_of(robot);
  if (!refusal.empty()) throw std::runtime_error("driver '" + driver + "': " + refusal);
  return robot;
}

}  // namespace forcebound::server
