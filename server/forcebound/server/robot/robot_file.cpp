#include <filesystem>
#include <string>

#include "forcebound/config/checked_table.hpp"
#include "forcebound/server/robot/robot_description.hpp"

namespace forcebound::server {
namespace {

using config::CheckedTable;
using config::NumberParameter;

NumberParameter positive(std::string_view key) { return {.key = key, .least = 0, .least_excluded = true}; }
NumberParameter not_negative(std::string_view key) { return {.key = key, .preset = 0, .least = 0}; }

Eigen::Vector3d point(CheckedTable& table, std::string_view key) { return table.vector({.key = key}, 3); }

/// One number of each joint, in the order of the vectors that they become.
struct JointNumbers {
  double lowest = 0;
  double highest = 0;
  double rest = 0;
  double speed_max = 0;
  double torque_max = 0;
  double torque_rate_max = 0;
  double damping = 0;
  double friction = 0;
  double encoder_step = 0;
  double actuator_step = 0;
};

JointNumbers read_numbers(CheckedTable& table) {
  JointNumbers joint;
  joint.lowest = table.number({.key = "lowest_rad"});
  joint.highest = table.number({.key = "highest_rad"});
  if (!(joint.lowest < joint.highest)) table.refuse("highest_rad", "> lowest_rad");
  joint.rest = table.number({.key = "rest_rad", .least = joint.lowest, .most = joint.highest});
  joint.speed_max = table.number(positive("speed_rad_per_s_max"));
  joint.torque_max = table.number(positive("torque_N_m_max"));
  joint.torque_rate_max = table.number(not_negative("torque_N_m_per_s_max"));
  joint.damping = table.number(positive("damping_N_m_s_per_rad"));
  joint.friction = table.number(not_negative("friction_N_m"));
  joint.encoder_step = table.number(not_negative("encoder_step_rad"));
  joint.actuator_step = table.number(not_negative("actuator_step_N_m"));
  return joint;
}

DescribedJoint read_link(CheckedTable& table) {
  DescribedJoint joint;
  joint.axis = point(table, "axis");
  if (joint.axis.isZero(0)) table.refuse("axis", "a direction, three numbers of which one is not 0");
  joint.point_m = point(table, "point_m");
  joint.mass_kg = table.number(positive("mass_kg"));
  joint.centre_m = point(table, "centre_m");
  joint.inertia_kg_m2 = table.matrix("inertia_kg_m2", 3);
  joint.rotor_kg_m2 = table.number(not_negative("rotor_kg_m2"));
  return joint;
}

Vector all_of(const std::vector<JointNumbers>& joints, double JointNumbers::*number) {
  Vector rows(static_cast<Eigen::Index>(joints.size()));
  for (Eigen::Index i = 0; i < rows.rows(); ++i) rows[i] = joints[static_cast<std::size_t>(i)].*number;
  return rows;
}

void read_joints(CheckedTable& file, RobotDescription& robot) {
  std::vector<JointNumbers> numbers;
  std::vector<DescribedJoint> links;
  file.each("joint", [&](CheckedTable& table, const std::string&) {
    numbers.push_back(read_numbers(table));
    links.push_back(read_link(table));
    table.refuse_unknown_keys();
  });
  if (numbers.empty() || numbers.size() > static_cast<std::size_t>(control::kJointsMax)) {
    file.fail("needs 1 to " + std::to_string(control::kJointsMax) + " tables [[joint]], got " +
              std::to_string(numbers.size()));
  }
  using N = JointNumbers;
  robot.facts.damping = all_of(numbers, &N::damping).asDiagonal();
  robot.facts.friction = all_of(numbers, &N::friction);
  robot.facts.encoder_step = all_of(numbers, &N::encoder_step);
  robot.facts.actuator_step = all_of(numbers, &N::actuator_step);
  robot.chain.rest = all_of(numbers, &N::rest);
  robot.chain.limits = {.lowest = all_of(numbers, &N::lowest),
                        .highest = all_of(numbers, &N::highest),
                        .speed_max = all_of(numbers, &N::speed_max),
                        .torque_max = all_of(numbers, &N::torque_max),
                        .torque_rate_max = all_of(numbers, &N::torque_rate_max)};
  robot.chain.links = links_of(links);
  const Eigen::Vector3d tool_m = point(file, "tool_m");
  robot.chain.tool = tool_of(links, tool_m, file.vector({.key = "tool_rad", .preset = 0}, 3));
}

ForceSensorFacts read_sensor(CheckedTable table) {
  ForceSensorFacts sensor;
  sensor.period =
      time::from_seconds(table.number({.key = "period_s", .least = 0, .least_excluded = true, .most = 0.1}));
  sensor.noise_N_sd = table.number(not_negative("noise_N_sd"));
  sensor.noise_N_m_sd = table.number(not_negative("noise_N_m_sd"));
  sensor.bias_N_max = table.number(not_negative("bias_N_max"));
  sensor.bias_N_m_max = table.number(not_negative("bias_N_m_max"));
  table.refuse_unknown_keys();
  return sensor;
}

void read_facts(CheckedTable& file, RobotDescription& robot) {
  control::DeviceFacts& facts = robot.facts;
  facts.period_s = file.number({.key = "period_s", .least = 1e-4, .most = 0.1});
  facts.hold_s_max = file.number({.key = "hold_s_max", .least = facts.period_s, .most = 1});
  facts.latency_s = file.number({.key = "latency_s", .preset = 0, .least = 0, .most = 0.01});
  facts.uncertainty.latency_s = {-facts.latency_s, 0};
  const double stamp_s = file.number({.key = "stamp_s_most", .preset = 0, .least = 0, .most = 0.01});
  facts.uncertainty.stamp_s = {-stamp_s, stamp_s};
  robot.identified = file.flag("identified", false);
  robot.brakes = file.flag("brakes", false);
  robot.compensates_gravity = file.flag("compensates_gravity", true);
  robot.chain.limits.tool_speed_m_per_s_max = file.number(positive("tool_speed_m_per_s_max"));
  robot.chain.limits.tool_turn_rad_per_s_max = file.number(positive("tool_turn_rad_per_s_max"));
  set_facts_from_limits(robot);
}

}  // namespace

RobotFile parse_robot(std::string_view text, const std::string& place) {
  const config::Node node = config::parse_toml(text, place);
  RobotFile robot;
  robot.robot.facts.name = std::filesystem::path(place).stem().string();
  robot.robot.chain.name = robot.robot.facts.name;
  CheckedTable file(node, place, "robot '" + robot.robot.facts.name + "'");
  (void)file.choice({.key = "kind", .choices = {"robot"}});
  if (file.find("driver") != nullptr) {
    const std::filesystem::path driver = file.text("driver");
    robot.driver = (driver.is_absolute() ? driver : std::filesystem::path(place).parent_path() / driver).string();
  }
  if (file.find("settings") != nullptr) {
    const CheckedTable settings = file.table("settings");
    for (const auto& [key, value] : *settings.node().as<config::Node::Table>()) {
      const auto* const words = value.as<std::string>();
      if (words == nullptr) settings.fail(value, std::string(key) + " must be a text, as the driver gets it");
      robot.settings.emplace_back(key, *words);
    }
  }
  read_joints(file, robot.robot);
  read_facts(file, robot.robot);
  if (file.find("sensor") != nullptr) robot.robot.sensor = read_sensor(file.table("sensor"));
  file.refuse_unknown_keys();
  const std::string refusal = refusal_of(robot.robot);
  if (!refusal.empty()) file.fail(refusal);
  return robot;
}

}  // namespace forcebound::server
