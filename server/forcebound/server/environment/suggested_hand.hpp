#pragma once

#include <memory>
#include <optional>
#include <string>

#include "forcebound/scene/scene.hpp"

namespace forcebound::config {
class CheckedTable;
}

namespace forcebound::server {

/// A simulated device and hand that touch something in a scene, as options of a client.
struct SuggestedHand {
  std::string device;     ///< "omni"
  std::string hand;       ///< "stroke:offset_z_m=0.015"
  bool computed = false;  ///< from the scene's surfaces; false: given by the scene's author
};

/// Reads `suggested_device` and `suggested_hand` of [scene] into the facts, whose degrees of freedom must be set.
/// @throws SceneError for a device that does not ship or does not fit, an unknown hand, and a recorded one, because its
/// file would have to lie with the client
void parse_suggestion(config::CheckedTable& scene, scene::SceneFacts& facts);

/// The author's suggestion; a missing device or hand is computed: the device by the degrees of freedom, and the first
/// hand that starts outside and touches (`try_hand`) of: a stroke from above over the middle of each object and dynamic
/// model, a press along each axis through the origin, a wave about a point of each surface. Where there is no surface,
/// or none of these can be simulated, a wave about the origin; where no hand touches, the first of these.
[[nodiscard]] SuggestedHand suggested_hand(const std::shared_ptr<const scene::Scene>& scene);

/// Where a hand begins [m]: where the author's does; else left of x = 0, and in space above z = 0, moved on to the
/// left, in space upwards, until it is outside of every shape and model.
[[nodiscard]] control::Vector place_to_begin(const scene::Scene& scene);

/// "--device omni --operator stroke:offset_z_m=0.015".
[[nodiscard]] std::string to_options(const SuggestedHand& suggested);

/// Result of trying a hand in a scene.
struct HandTrial {
  static constexpr double kLongest_s = 10;

  bool starts_inside = false;  ///< of an object
  std::optional<double>
      touched_s{};  ///< time of the first force from a surface, or, in a scene without surfaces, of the first force
  std::size_t contacts = 0;  ///< of the points that touch objects then
};

/// Runs the simulated device with the hand on it in the scene, in virtual time and without a network, until it touches
/// something, 10 s at most.
/// @throws std::exception if the device or hand is unknown
[[nodiscard]] HandTrial try_hand(const std::shared_ptr<const scene::Scene>& scene, const SuggestedHand& suggested);

}  // namespace forcebound::server
