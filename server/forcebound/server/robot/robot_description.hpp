#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/driver/forcebound_device.h"
#include "forcebound/server/robot/robot.hpp"
#include "forcebound/server/robot/serial_chain.hpp"

namespace forcebound::server {

/// All that is known of a robot behind a driver.
struct RobotDescription {
  control::DeviceFacts facts;  ///< in its joints, as Robot has them
  SerialChain::Description chain;
  bool identified = false;          ///< false: the bounds are guesses
  bool brakes = false;              ///< `stop` closes them
  bool compensates_gravity = true;  ///< false: the program adds what holds the robot
  std::optional<ForceSensorFacts> sensor{};
};

/// A robot's joint as drivers and files tell it: base frame, all joints at zero.
struct DescribedJoint {
  Eigen::Vector3d axis{0, 0, 1};
  Eigen::Vector3d point_m{Eigen::Vector3d::Zero()};
  Eigen::Vector3d centre_m{Eigen::Vector3d::Zero()};
  double mass_kg = 0;
  Eigen::Matrix3d inertia_kg_m2{Eigen::Matrix3d::Zero()};
  double rotor_kg_m2 = 0;
};

/// Links as SerialChain has them: with frames whose axes are the base's where all joints are at zero.
[[nodiscard]] std::vector<ChainLink> links_of(const std::vector<DescribedJoint>& joints);

/// The tool in the last link's frame.
[[nodiscard]] Eigen::Isometry3d tool_of(const std::vector<DescribedJoint>& joints, const Eigen::Vector3d& tool_m,
                                        const Eigen::Vector3d& tool_rad);

/// The facts that follow from the joints' limits: the largest torque, and the speed beyond which a reading is not
/// believed, four times the largest of a joint.
void set_facts_from_limits(RobotDescription& robot);

/// What holds beyond the ranges of single numbers. @return why it is refused; empty: it is not
[[nodiscard]] std::string refusal_of(const RobotDescription& robot);

/// As a driver tells it.
/// @throws std::runtime_error in one line, beginning with the driver's name: what is missing or cannot be
[[nodiscard]] RobotDescription description_of(const forcebound_robot& told, const std::string& driver);

/// A robot's file: its facts, and which driver it has.
struct RobotFile {
  std::string driver{};  ///< path; empty: the file names none
  std::vector<std::pair<std::string, std::string>> settings{};
  RobotDescription robot;
};

/// @param text of the file, named by `place` in errors. @throws config::ConfigError with file, line and accepted values
[[nodiscard]] RobotFile parse_robot(std::string_view text, const std::string& place);

}  // namespace forcebound::server
