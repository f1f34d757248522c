#pragma once

#include <optional>
#include <string>
#include <vector>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/server/robot/serial_chain.hpp"
#include "forcebound/server/robot/task_world.hpp"

struct mjModel_;

namespace forcebound::server {

/// The arm that ships, as MJCF, with the block of a task's world, if it has one.
[[nodiscard]] std::string arm_mjcf(const Task::World& world);

/// Where the parts of the arm are in MuJoCo's vectors.
struct ArmLayout {
  /// A finger's servo.
  struct Finger {
    int position = 0;  ///< in qpos
    int speed = 0;     ///< in qvel
    double travel_m = 0;
    double force_N_max = 0;
    double stiffness_N_per_m = 0;
    double damping_N_s_per_m = 0;
  };
  int joints = 0;     ///< the first ones of qpos and qvel
  int tool_body = 0;  ///< the tool is fixed to it
  int tool_site = 0;
  std::vector<Finger> fingers;
  std::optional<int> block_body;  ///< of a free joint
  int block_position = 0;         ///< in qpos
  int block_speed = 0;            ///< in qvel
};

/// @throws std::runtime_error if the model is none of an arm
[[nodiscard]] ArmLayout layout_of(const mjModel_& model);

/// Geometry and masses as in MuJoCo's model, the fingers where they are at the start.
[[nodiscard]] SerialChain chain_of(const mjModel_& model, const ArmLayout& layout);

/// Damping and friction are exactly what the simulation has.
[[nodiscard]] control::DeviceFacts facts_of(const mjModel_& model, const ArmLayout& layout);

}  // namespace forcebound::server
