#pragma once

#include <memory>
#include <string>

#include "forcebound/server/robot/driver_robot.hpp"

namespace forcebound::test {

/// The file of a robot's driver for tests.
inline std::string robot_driver(const std::string& name = "arm") {
  return std::string(FORCEBOUND_TEST_DRIVERS) + "/robots/forcebound-device-" + name + ".so";
}

/// The simulated arm behind its driver.
inline std::unique_ptr<server::DriverRobot> driven_arm(const std::string& settings = {}) {
  return server::open_robot(robot_driver() + ":" + settings);
}

/// A robot's file that agrees with that driver but for what is given.
struct RobotFileText {
  std::string head{};  ///< more keys, before the joints
  std::string joint{};
  double period_s = 0.001;
  double torque_N_m = 20;
  int joints = 7;
  std::string line{};  ///< in place of the first that begins with the same key

  [[nodiscard]] std::string text() const {
    std::string file = all();
    if (line.empty()) return file;
    const std::size_t at = file.find("\n" + line.substr(0, line.find(' ')) + " ") + 1;
    return file.replace(at, file.find('\n', at) - at, line);
  }

 private:
  [[nodiscard]] std::string all() const {
    std::string file = "kind = 'robot'\nperiod_s = " + std::to_string(period_s) +
                       "\nhold_s_max = 0.01\ntool_m = [0, 0, 1.2]\ntool_speed_m_per_s_max = 1\n"
                       "tool_turn_rad_per_s_max = 2\n" +
                       head;
    for (int i = 0; i < joints; ++i) {
      file += "[[joint]]\nname = 'j" + std::to_string(i + 1) + "'\naxis = " + (i % 2 == 0 ? "[0, 0, 1]" : "[0, 1, 0]") +
              "\npoint_m = [0, 0, " + std::to_string(0.15 * i) +
              "]\nlowest_rad = -2\nhighest_rad = 2\nrest_rad = 0.5\n" +
              "speed_rad_per_s_max = 2\ntorque_N_m_max = " + std::to_string(torque_N_m) +
              "\ndamping_N_m_s_per_rad = 1\nmass_kg = 0.2\ncentre_m = [0, 0, " + std::to_string(0.15 * i + 0.1) +
              "]\ninertia_kg_m2 = 0.001\n" + joint;
    }
    return file;
  }
};

}  // namespace forcebound::test
