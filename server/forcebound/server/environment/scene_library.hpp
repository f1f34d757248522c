#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/scene/scene.hpp"
#include "forcebound/server/environment/scene_parser.hpp"

namespace forcebound::server {

/// What a library has of a name. All members empty: the name is unknown.
template <class Wanted>
struct Requested {
  std::shared_ptr<const Wanted> found{};
  bool coming = false;    ///< the scene is being compiled on another thread: retry later
  std::string why_not{};  ///< reason why the scene did not compile
};

/// The scenes that clients can request by name. A shipped scene is compiled once, at its first request, so that the
/// server starts at once: that takes milliseconds, with tissue a tenth of a second, with `accuracy = "auto"` as long as
/// measuring each level takes.
///
/// Copies share one library. Not thread-safe.
class SceneLibrary {
 public:
  SceneLibrary();

  /// The scenes that ship with the server.
  /// @param measure as parse_scene's
  static SceneLibrary shipped(scene::Registry registry = scene::Registry::standard(), scene::MeasureCost measure = {});

  /// Another library of the same scenes, for another thread. Each scene that ships is still compiled once, for all
  /// copies, and one at a time: who wants one that is not compiled waits; one that is, is found at once.
  [[nodiscard]] SceneLibrary copy() const;

  /// Replaces a scene of the same name, also a shipped one.
  void add(std::shared_ptr<const scene::Scene> scene);

  /// The compilation of one scene. It does not touch the library, so another thread may run it.
  struct Compilation {
    std::string name;
    std::function<std::shared_ptr<const scene::Scene>()> compile;  ///< @throws SceneError if it does not compile
  };

  /// From now on `request` passes each compilation to `elsewhere` and does not wait for it. The receiver passes the
  /// result to `add`, or the failure to `give_up`. Compilations passed to an earlier `elsewhere` are forgotten: the
  /// next request starts them again. With an empty function `request` compiles at once and waits.
  void compile_elsewhere(std::function<void(Compilation)> elsewhere);

  /// The compilation failed. The next request reports `why`; the one after retries.
  void give_up(std::string_view name, std::string why);

  /// Null if the name is unknown. Never opens files, because the name may come from a client.
  [[nodiscard]] std::shared_ptr<const scene::Scene> find(std::string_view name) const;

  /// As `find`, without waiting for a compilation if `compile_elsewhere` was called.
  [[nodiscard]] Requested<scene::Scene> request(std::string_view name) const;

  [[nodiscard]] std::vector<std::string> all_names() const;

  /// "box, circle, ...".
  [[nodiscard]] std::string names() const;

  /// "no scene 'spere', did you mean 'sphere'? (known: box, circle, ...)".
  [[nodiscard]] std::string unknown_scene_text(std::string_view name) const;

 private:
  class Compiled;
  struct Shelf;

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
