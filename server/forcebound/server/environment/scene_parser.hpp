#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "forcebound/config/config_error.hpp"
#include "forcebound/config/parameter.hpp"
#include "forcebound/scene/registry.hpp"
#include "forcebound/scene/scene.hpp"

namespace forcebound::server {

/// A scene that does not compile; `what()` is one line: file, line, object, effect, what is wrong and what would be
/// right.
using SceneError = config::ConfigError;

/// [scene].
[[nodiscard]] config::TableDescription scene_table();

/// Compiles the text of a scene file (server/scenes has examples).
///
/// Points have as many numbers as the scene has degrees of freedom; a scene for "any" device lies on its first axis, so
/// they have one.
///
/// @param file_name for errors
/// @param measure what a motion takes in each level of a scene with `accuracy = "auto"`; none: as predicted
/// @throws SceneError
std::shared_ptr<const scene::Scene> parse_scene(std::string_view text, const std::string& file_name,
                                                const scene::Registry& registry = scene::Registry::standard(),
                                                const scene::MeasureCost& measure = {});

/// Another value for a key of a scene file: "tissue.pad.shape.cells", as set_scene_key finds it.
struct SceneChange {
  std::string key;
  std::string value;  ///< as TOML writes it
};

/// The scene that a file would be with other values for some keys, one after the other, and without the levels that it
/// may be picked from. Errors name lines of the file as it is.
/// @throws SceneError
std::shared_ptr<const scene::Scene> parse_changed_scene(std::string_view text, const std::string& file_name,
                                                        std::span<const SceneChange> changes,
                                                        const scene::Registry& registry = scene::Registry::standard());

}  // namespace forcebound::server
