#pragma once

#include <string>

#include "forcebound/scene/scene.hpp"

namespace forcebound::client {

/// Triangles of a mesh, or squares of a relief, that a page is sent at most; larger ones are only named.
inline constexpr std::size_t kTrianglesShownMost = 60000;

/// The message `scene` of the parts that run at this client: shapes with all their values, presets included; reliefs
/// and other shapes of triangles as meshes. What has no shape, and what is only at the server, is named in `more`.
///
/// @param simulated what the server says it simulates, in words; may be empty
[[nodiscard]] std::string scene_message(int track, const scene::Scene& scene, const std::string& simulated);

/// The same while no part of it is here.
[[nodiscard]] std::string unknown_scene_message(int track, const std::string& name, const std::string& more);

}  // namespace forcebound::client
