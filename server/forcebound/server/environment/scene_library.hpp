#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/scene/scene.hpp"
#include "forcebound/server/environment/scene_parser.hpp"

namespace forcebound::server {

/// The scenes that clients may ask for, by name. One that ships is compiled when it is first asked for, once: that
/// takes milliseconds, with tissue a tenth of a second, with `accuracy = "auto"` what it takes to measure each level,
/// and a server starts without it.
///
/// Copies are the same library. Not thread-safe.
class SceneLibrary {
 public:
  SceneLibrary();

  /// Those that ship with the server.
  /// @param measure as parse_scene's
  static SceneLibrary shipped(scene::EffectRegistry registry = scene::EffectRegistry::standard(),
                              scene::MeasureCost measure = {});

  /// Replaces a scene of the same name: what a server's owner wrote goes before what we ship.
  void add(std::shared_ptr<const scene::Scene> scene);

  /// What is left to do for a scene; it does not touch the library, and may be done on another thread.
  struct Compilation {
    std::string name;
    std::function<std::shared_ptr<const scene::Scene>()> compile;  ///< @throws what keeps it from being had
  };

  /// Who asks by `request` for a scene that is not compiled does not wait: `elsewhere` is given what is to be done, and
  /// `add` or `give_up` what came of it. What somebody else was given before is asked for anew; without `elsewhere`,
  /// whoever asks waits.
  void compile_elsewhere(std::function<void(Compilation)> elsewhere);

  /// Who asks next is told why, and who asks then has it tried again.
  void give_up(std::string_view name, std::string why);

  /// Null if there is none. Never looks at files, so that a client cannot either.
  [[nodiscard]] std::shared_ptr<const scene::Scene> find(std::string_view name) const;

  struct Requested {
    std::shared_ptr<const scene::Scene> scene{};
    bool coming = false;    ///< being compiled elsewhere: ask again
    std::string why_not{};  ///< it is known, but could not be compiled
  };

  /// As `find`, for those who cannot wait.
  [[nodiscard]] Requested request(std::string_view name) const;

  [[nodiscard]] std::vector<std::string> all_names() const;

  /// "box, circle, ...".
  [[nodiscard]] std::string names() const;

  /// "no scene 'spere', did you mean 'sphere'? (known: box, circle, ...)".
  [[nodiscard]] std::string unknown_scene_text(std::string_view name) const;

 private:
  struct Shelf;

  std::shared_ptr<Shelf> shelf_;
};

/// The text of a scene, and the name of its file for errors and for files beside it.
struct SceneSource {
  std::string text;
  std::string file;
};

/// As `load_scene`, not yet compiled. @throws SceneError
SceneSource scene_source(const std::string& name_or_file);

/// A shipped scene by its name, or the scene in a file: what contains a '/' or ends in ".toml" is a file.
/// @param measure as parse_scene's
/// @throws SceneError
std::shared_ptr<const scene::Scene> load_scene(
    const std::string& name_or_file, const scene::EffectRegistry& registry = scene::EffectRegistry::standard(),
    const scene::MeasureCost& measure = {});

}  // namespace forcebound::server
