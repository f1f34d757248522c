#pragma once

#include <string>

#include "forcebound/config/checked_table.hpp"
#include "forcebound/scene/part.hpp"

namespace forcebound::server {

/// Descriptions of [[object]] and [[field]], without the tables of their effects.
[[nodiscard]] config::TableDescription object_table();
[[nodiscard]] config::TableDescription field_table();

/// Reads an [[object]] or a [[field]] made of registered shapes and effects.
/// @param axes of the scene
/// @param tool_reach_m of the points that touch it, Tool::reach_of_points_m
/// @throws SceneError
[[nodiscard]] scene::SceneObject parse_part(config::CheckedTable& part, const std::string& name, bool is_object,
                                            const scene::Registry& registry, Eigen::Index axes,
                                            double tool_reach_m = 0);

/// Reads the table `shape` of a part.
/// @throws SceneError
void parse_shape(config::CheckedTable& part, const scene::Registry& registry, scene::SceneObject& made,
                 Eigen::Index axes);

}  // namespace forcebound::server
