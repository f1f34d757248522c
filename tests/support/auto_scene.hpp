#pragma once

#include <memory>
#include <string>

#include "forcebound/server/environment/scene_parser.hpp"
#include "tests/support/auto_wall.hpp"

namespace forcebound::test {

/// Two levels: the stiff one takes 2 ms, the soft one no time.
inline std::shared_ptr<const scene::Scene> auto_wall() {
  return server::parse_scene(kAutoWall, "auto_wall.toml", scene::Registry::standard(),
                             [](const std::shared_ptr<const scene::Scene>& scene) {
                               const std::string& parameters = scene->objects().at(0).effects.at(0).parameters;
                               return parameters.find(" 200") == std::string::npos ? 0.0 : 2e-3;
                             });
}

}  // namespace forcebound::test
