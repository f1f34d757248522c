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
  static SceneLibrary shipped(scene::Registry registry = scene::Registry::standard(), scene::MeasureCost measure = {});

  /// Replaces a scene of the same name: what a server's owner wrote goes before what we ship.
  void add(std::shared_ptr<const scene::Scene> scene);

  /// The compilation of one scene. It does not touch the library, so another thread may run it.
  struct Compilation {
    std::string name;
    std::function<std::shared_ptr<const scene::Scene>()> compile;  ///< @throws why the scene does not compile
  };

  /// From now on `request` hands the compilation of a scene to `elsewhere` instead of waiting for it; its result is
  /// passed to `add`, or its failure to `give_up`. Compilations that an earlier `elsewhere` was given are forgotten:
  /// the next request hands them out again. With an empty function `request` compiles at once and waits.
  void compile_elsewhere(std::function<void(Compilation)> elsewhere);

  /// The compilation failed. The next request reports `why`; the one after retries.
  void give_up(std::string_view name, std::string why);

  /// Null if there is none. Never looks at files, so that a client cannot either.
  [[nodiscard]] std::shared_ptr<const scene::Scene> find(std::string_view name) const;

  struct Requested {
    std::shared_ptr<const scene::Scene> scene{};
    bool coming = false;    ///< being compiled elsewhere: ask again
    std::string why_not{};  ///< the scene exists, but did not compile
  };

  /// As `find`, without waiting for a compilation if `compile_elsewhere` was called.
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
std::shared_ptr<const scene::Scene> load_scene(const std::string& name_or_file,
                                               const scene::Registry& registry = scene::Registry::standard(),
                                               const scene::MeasureCost& measure = {});

}  // namespace forcebound::server
