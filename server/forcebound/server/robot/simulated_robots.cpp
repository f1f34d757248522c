#include "forcebound/server/robot/simulated_arm.hpp"

namespace forcebound::server {

bool has_simulated_robots() noexcept { return true; }

std::unique_ptr<TaskRobot> make_robot(const Task& task, std::uint64_t seed) {
  return std::make_unique<SimulatedArm>(task, seed);
}

}  // namespace forcebound::server
