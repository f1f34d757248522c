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

/// A robot that can be asked for by name. A driver of a real one is a line in `robot_kinds`.
struct RobotKind {
  std::string_view name;
  std::string_view summary;
  bool simulated = true;  ///< it works in the simulated world of its task; a real one has its own

  /// @param seed of what is random in a simulation. @throws std::runtime_error with the reason why it is not available
  std::function<std::unique_ptr<Robot>(const Task& task, std::uint64_t seed)> make{};
};

/// All of them.
[[nodiscard]] const std::vector<RobotKind>& robot_kinds();

/// Their names.
[[nodiscard]] std::vector<std::string> robot_names();

/// @throws std::invalid_argument naming the nearest one and the known ones
[[nodiscard]] const RobotKind& find_robot(std::string_view name);

}  // namespace forcebound::server
