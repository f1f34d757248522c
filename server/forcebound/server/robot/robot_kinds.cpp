#include "forcebound/server/robot/robot_kinds.hpp"

#include <algorithm>
#include <stdexcept>

#include "forcebound/server/robot/driver_robot.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::server {
namespace {

constexpr std::string_view kDriver = "driver:";

}  // namespace

bool is_driven(std::string_view robot) noexcept { return robot.starts_with(kDriver) || robot.ends_with(".toml"); }

std::unique_ptr<Robot> make_driven(const std::string& robot) {
  if (!robot.starts_with(kDriver)) return open_robot_of_file(robot);
  return open_robot(std::string_view(robot).substr(kDriver.size()));
}

const std::vector<RobotKind>& robot_kinds() {
  static const std::vector<RobotKind> kAll{
      {.name = "reach-7",
       .summary = "a simulated arm of seven joints with a gripper and a force sensor",
       .make = [](const Task& task, std::uint64_t seed) -> std::unique_ptr<Robot> { return make_robot(task, seed); }},
  };
  return kAll;
}

std::vector<std::string> robot_names() {
  std::vector<std::string> names;
  for (const RobotKind& kind : robot_kinds()) names.emplace_back(kind.name);
  return names;
}

const RobotKind& find_robot(std::string_view name) {
  const auto& all = robot_kinds();
  const auto found = std::ranges::find(all, name, &RobotKind::name);
  if (found != all.end()) return *found;
  throw std::invalid_argument("no robot '" + text::printable(name) + "'" + text::suggestion(name, robot_names()) +
                              "; or driver:FILE.so, or the path of a .toml file");
}

}  // namespace forcebound::server
