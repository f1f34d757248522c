#pragma once

#include <vector>

#include "forcebound/server/scene/checked_table.hpp"
#include "forcebound/server/scene/scene.hpp"

namespace forcebound::server {

/// Reads every [[tissue]] of a file.
/// @throws SceneError
std::vector<SceneMedium> parse_tissues(CheckedTable& file);

}  // namespace forcebound::server
