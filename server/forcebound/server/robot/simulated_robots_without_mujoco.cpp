// Stands in for simulated_robots.cpp where MuJoCo is missing.
#include <stdexcept>

#include "forcebound/server/robot/task.hpp"

namespace forcebound::server {

bool has_simulated_robots() noexcept { return false; }

std::unique_ptr<TaskRobot> make_robot(const Task& task, std::uint64_t) {
  throw std::runtime_error("task '" + task.name +
                           "' needs a simulated robot, which needs MuJoCo, and this Forcebound was built without: "
                           "install it (Debian: libmujoco-dev libqhull-dev libtinyxml2-dev) and configure and build "
                           "again");
}

}  // namespace forcebound::server
