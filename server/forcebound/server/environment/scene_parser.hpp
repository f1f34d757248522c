#pragma once

#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "forcebound/scene/effects/registry.hpp"
#include "forcebound/scene/scene.hpp"

namespace forcebound::server {

/// A scene that does not compile; `what()` is one line: file, line, object, effect, what is wrong and what would be
/// right.
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Of a shared scene.
inline constexpr scene::NumberParameter kClientsMax{
    .key = "clients_max", .meaning = "at once in a shared scene, a whole number", .preset = 4, .least = 1, .most = 16};

/// Compiles the text of a scene file (server/scenes has examples).
///
/// Points have as many numbers as the scene has degrees of freedom; a scene for "any" device lies on its first axis, so
/// they have one.
///
/// @param file_name for errors
/// @param measure what a motion takes in each level of a scene with `accuracy = "auto"`; none: as predicted
/// @throws SceneError
std::shared_ptr<const scene::Scene> parse_scene(
    std::string_view text, const std::string& file_name,
    const scene::EffectRegistry& registry = scene::EffectRegistry::standard(), const scene::MeasureCost& measure = {});

/// Another value for a key of a scene file: "tissue.pad.shape.cells", as set_scene_key finds it.
struct SceneChange {
  std::string key;
  std::string value;  ///< as TOML writes it
};

/// The scene that a file would be with other values for some keys, one after the other, and without the levels that it
/// may be picked from. Errors name lines of the file as it is.
/// @throws SceneError
std::shared_ptr<const scene::Scene> parse_changed_scene(
    std::string_view text, const std::string& file_name, std::span<const SceneChange> changes,
    const scene::EffectRegistry& registry = scene::EffectRegistry::standard());

}  // namespace forcebound::server
