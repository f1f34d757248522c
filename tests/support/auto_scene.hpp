#pragma once

#include <memory>
#include <string>

#include "forcebound/server/scene/scene_parser.hpp"

namespace forcebound::test {

/// A wall for any device that may be soft and quick, or stiff and slow: the softer, the rougher the model is said to
/// be.
inline constexpr const char* kAutoWall = R"([scene]
name = "auto_wall"
description = "A wall of two kinds."
degrees_of_freedom = "any"
accuracy = "auto"

[accuracy]
key = "object.wall.surface.stiffness_N_per_m"
change_per_s = 20
levels = [
  { value = 100.0, model_error = 0.1 },
  { value = 200.0, model_error = 0.01 },
]

[[object]]
name = "wall"
shape = { kind = "half_space", through_m = [0], normal = [-1] }
effects = ["surface"]

[object.surface]
stiffness_N_per_m = 150
)";

/// The stiff one takes 2 ms, the soft one no time.
inline std::shared_ptr<const server::Scene> auto_wall() {
  return server::parse_scene(kAutoWall, "auto_wall.toml", server::EffectRegistry::standard(),
                             [](const std::shared_ptr<const server::Scene>& scene) {
                               const std::string& parameters = scene->objects().at(0).effects.at(0).parameters;
                               return parameters.find(" 200") == std::string::npos ? 0.0 : 2e-3;
                             });
}

}  // namespace forcebound::test
