#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>

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
  double counted_from_s = 0;  ///< what happened before is passed over
};

}  // namespace forcebound::lab
