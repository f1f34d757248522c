#pragma once

#include <vector>

#include "forcebound/scene/scene.hpp"
#include "forcebound/server/environment/checked_table.hpp"

namespace forcebound::server {

/// Reads every [[body]] of a file: those with shapes become one dynamic model, set up by [bodies]; each MJCF file
/// becomes another.
/// @throws SceneError
std::vector<scene::SceneDynamicModel> parse_bodies(CheckedTable& file);

/// Whether Forcebound was built with MuJoCo. Without, parse_bodies() refuses every body.
bool has_bodies() noexcept;

}  // namespace forcebound::server
