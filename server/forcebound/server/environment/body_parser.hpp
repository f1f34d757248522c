#pragma once

#include <vector>

#include "forcebound/config/checked_table.hpp"
#include "forcebound/scene/scene.hpp"

namespace forcebound::server {

/// Descriptions of [bodies] and [[body]], and of the tables within them.
[[nodiscard]] std::vector<config::TableDescription> body_tables();

/// Reads every [[body]] of a file: those with shapes become one dynamic model, set up by [bodies]; each MJCF file
/// becomes another.
/// @throws SceneError
std::vector<scene::SceneDynamicModel> parse_bodies(config::CheckedTable& file);

}  // namespace forcebound::server
