#pragma once

#include "forcebound/config/checked_table.hpp"
#include "forcebound/scene/registry.hpp"
#include "forcebound/scene/scene.hpp"

namespace forcebound::server {

/// Descriptions of [tool] and [[tool.part]].
[[nodiscard]] config::TableDescription tool_table();
[[nodiscard]] config::TableDescription tool_part_table();

/// Reads the tool in the hand into the scene's facts: where its tip is, and with which points it touches.
/// @param facts of a scene whose degrees of freedom are known
/// @throws SceneError
void parse_tool(config::CheckedTable& file, const scene::Registry& registry, scene::SceneFacts& facts);

/// A tool with a shape touches neither tissue nor bodies, and feels no effect of objects whose force the client changes
/// by itself: ripples, and what fades without a server.
/// @throws SceneError
void check_tool(config::CheckedTable& file, const scene::SceneFacts& facts, const scene::SceneParts& parts);

}  // namespace forcebound::server
