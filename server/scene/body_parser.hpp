#pragma once

#include <vector>

#include "forcebound/server/scene/checked_table.hpp"
#include "forcebound/server/scene/scene.hpp"

namespace forcebound::server {

/// Reads every [[body]] of a file: those with shapes become one medium, set up by [bodies]; each MJCF file becomes
/// another.
/// @throws SceneError
std::vector<SceneMedium> parse_bodies(CheckedTable& file);

}  // namespace forcebound::server
