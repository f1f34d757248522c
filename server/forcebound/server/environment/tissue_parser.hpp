#pragma once

#include <vector>

#include "forcebound/config/checked_table.hpp"
#include "forcebound/scene/scene.hpp"

namespace forcebound::server {

/// Descriptions of [[tissue]] and of the tables within it.
[[nodiscard]] std::vector<config::TableDescription> tissue_tables();

/// Reads every [[tissue]] of a file.
/// @throws SceneError
std::vector<scene::SceneDynamicModel> parse_tissues(config::CheckedTable& file);

}  // namespace forcebound::server
