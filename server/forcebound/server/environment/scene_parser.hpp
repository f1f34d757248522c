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

/// A scene that does not compile; `what()` is one line: file, line, object, effect, the error and what would be
/// accepted.
using SceneError = config::ConfigError;

/// Description of the table [scene].
[[nodiscard]] config::TableDescription scene_table();

/// Compiles the text of a scene file (server/scenes has examples).
///
/// Points have as many numbers as the scene has degrees of freedom; in a scene for "any" device, which lies on the
/// first axis, they have one.
///
/// @param file_name for errors
/// Files that it names must lie in its own folder or below.
///
/// @param measure time for a motion in each level of a scene with `accuracy = "auto"`; none: the predicted time
/// @param folders in which files that it names may lie too
/// @throws SceneError
std::shared_ptr<const scene::Scene> parse_scene(std::string_view text, const std::string& file_name,
                                                const scene::Registry& registry = scene::Registry::standard(),
                                                const scene::MeasureCost& measure = {},
                                                std::span<const std::string> folders = {});

/// Another value for a key of a scene file: "tissue.pad.shape.cells", as set_scene_key finds it.
struct SceneChange {
  std::string key;
  std::string value;  ///< in TOML syntax
};

/// Compiles a scene file with other values for some keys, applied in order, and without its accuracy levels. Errors
/// name lines of the unchanged file.
/// @throws SceneError
std::shared_ptr<const scene::Scene> parse_changed_scene(std::string_view text, const std::string& file_name,
                                                        std::span<const SceneChange> changes,
                                                        const scene::Registry& registry = scene::Registry::standard());

}  // namespace forcebound::server
