#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/scene/scene.hpp"
#include "forcebound/server/environment/scene_parser.hpp"
#include "forcebound/server/offer/environment_library.hpp"

namespace forcebound::server {

/// The scenes that ship and those that a program adds, by name. A scene that ships is compiled once, at its first
/// request: that takes milliseconds, with tissue a tenth of a second, with `accuracy = "auto"` as long as measuring
/// each level takes.
///
/// Copies share one library. Thread-safe: scenes are compiled one at a time; who wants one that is not compiled waits,
/// one that is, is found at once.
class SceneLibrary {
 public:
  SceneLibrary();

  /// The scenes that ship with the server.
  /// @param measure as parse_scene's
  static SceneLibrary shipped(scene::Registry registry = scene::Registry::standard(), scene::MeasureCost measure = {});

  /// Replaces a scene of the same name, also a shipped one.
  void add(std::shared_ptr<const scene::Scene> scene);

  /// Null if the name is unknown. Never opens files, because the name may come from a client.
  /// @throws SceneError if it does not compile
  [[nodiscard]] std::shared_ptr<const scene::Scene> find(std::string_view name) const;

  [[nodiscard]] std::vector<std::string> all_names() const;

  /// "box, circle, ...".
  [[nodiscard]] std::string names() const;

  /// "no scene 'spere', did you mean 'sphere'? (known: box, circle, ...)".
  [[nodiscard]] std::string unknown_scene_text(std::string_view name) const;

  /// Every scene that is in it now, as an environment that is made when it is requested. Implicit, so that a
  /// SceneLibrary can be passed to a server directly.
  operator EnvironmentLibrary() const;  // NOLINT(google-explicit-constructor)

 private:
  class Shelf;
  std::shared_ptr<Shelf> shelf_;
};

/// The text of a scene, and the name of its file for errors and for files beside it.
struct SceneSource {
  std::string text;
  std::string file;
};

/// Whether this is a file's path (has a '/' or ends with ".toml") rather than the name of a scene.
[[nodiscard]] bool is_scene_file(std::string_view name_or_file) noexcept;

/// The text that `load_scene` would compile. @throws SceneError
SceneSource scene_source(const std::string& name_or_file);

/// A shipped scene by its name, or the scene in a file, as is_scene_file tells.
/// @param measure as parse_scene's
/// @param folders as parse_scene's
/// @throws SceneError
std::shared_ptr<const scene::Scene> load_scene(const std::string& name_or_file,
                                               const scene::Registry& registry = scene::Registry::standard(),
                                               const scene::MeasureCost& measure = {},
                                               std::span<const std::string> folders = {});

}  // namespace forcebound::server
