#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/server/robot/robot.hpp"
#include "forcebound/server/robot/task.hpp"

namespace forcebound::server {

/// A robot that can be asked for by name. A real one is asked for by its driver or its file (is_driven).
struct RobotKind {
  std::string_view name;
  std::string_view summary;

  /// @param seed of what is random in a simulation. @throws std::runtime_error with the reason why it is not available
  std::function<std::unique_ptr<Robot>(const Task& task, std::uint64_t seed)> make{};
};

/// Whether this asks for a robot behind a driver, which has work of its own: `driver:FILE.so[:KEY=VALUE,...]`, or
/// `ROBOT.toml`, a file that names its driver.
[[nodiscard]] bool is_driven(std::string_view robot) noexcept;

/// Opens it. @throws std::exception in one line
[[nodiscard]] std::unique_ptr<Robot> make_driven(const std::string& robot);

/// All of them.
[[nodiscard]] const std::vector<RobotKind>& robot_kinds();

/// Their names.
[[nodiscard]] std::vector<std::string> robot_names();

/// @throws std::invalid_argument naming the nearest one and the known ones
[[nodiscard]] const RobotKind& find_robot(std::string_view name);

}  // namespace forcebound::server
