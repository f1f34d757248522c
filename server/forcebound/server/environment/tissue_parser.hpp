#pragma once

#include <vector>

#include "forcebound/scene/scene.hpp"
#include "forcebound/server/environment/checked_table.hpp"

namespace forcebound::server {

/// Reads every [[tissue]] of a file.
/// @throws SceneError
std::vector<scene::SceneDynamicModel> parse_tissues(CheckedTable& file);

}  // namespace forcebound::server
