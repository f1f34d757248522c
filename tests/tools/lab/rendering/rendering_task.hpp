#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/device/device_description.hpp"
#include "forcebound/device/simulated/operator.hpp"
#include "forcebound/scene/scene.hpp"

namespace forcebound::lab {

/// What local rendering is to reach behind a network.
struct RenderingGoal {
  double stiffness = 0.99;  ///< displayed, over that without a network: at least
  double error = 0.01;      ///< E_dev beyond that without a network: at most; infinite: any
};

/// Of tissue and bodies, which the client knows by local models alone.
inline constexpr RenderingGoal kGoalOfWhatMoves{.stiffness = 0.95, .error = std::numeric_limits<double>::infinity()};

/// What local and remote rendering are compared on: a scene that its device shows without a network, and a hand that
/// touches it, where the name does not say otherwise, from 2 s after the start on.
struct RenderingTask {
  std::string name;
  std::string group;  ///< the class of scenes that it belongs to; all of a class have the same goal
  RenderingGoal goal{};
  std::shared_ptr<const scene::Scene> scene;
  device::DeviceDescription device;
  std::function<std::unique_ptr<const device::Operator>()> make_hand;
};

/// Of scenes that stand still: plane, primitives, corner, edge, friction, stick-slip, height field, and meshes of 5,856
/// and 70,000 triangles at 0.05 to 0.5 m/s, on a firm device (30 N s/m, 15 um) at 10 N/mm; a plane and a mesh on a
/// light one (1 N s/m, 20 um) at 1 N/mm; a mesh of 181,920 touched at once. And of what moves, by local models: a pad
/// of tissue under a point and a ball, and, where there are bodies, a puck that is dragged, free and against a stop,
/// and those of body_tasks.hpp.
[[nodiscard]] std::vector<RenderingTask> rendering_tasks();

}  // namespace forcebound::lab
