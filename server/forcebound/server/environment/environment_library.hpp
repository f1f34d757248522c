#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "forcebound/server/environment/environment.hpp"
#include "forcebound/server/environment/scene_library.hpp"

namespace forcebound::server {

/// The environments that clients may ask for, by name: scenes, and what a program adds of its own.
///
/// Copies are the same library. Not thread-safe.
class EnvironmentLibrary {
 public:
  EnvironmentLibrary();

  /// Every scene of that library is an environment, also one that is added to it later; so it converts by itself.
  EnvironmentLibrary(SceneLibrary scenes);

  /// Replaces an environment of the same name, and goes before a scene of that name.
  /// @throws std::invalid_argument without a name or without `make`
  void add(EnvironmentKind kind);

  struct Requested {
    std::shared_ptr<const EnvironmentKind> kind{};
    bool coming = false;    ///< being compiled elsewhere: ask again
    std::string why_not{};  ///< it is known, but could not be compiled
  };

  /// Nothing of it is set: there is none of this name. A scene keeps its kind as long as it is not replaced.
  [[nodiscard]] Requested request(std::string_view name) const;

  /// As `request`, but a scene that is not yet compiled is compiled now. Null if there is none.
  [[nodiscard]] std::shared_ptr<const EnvironmentKind> find(std::string_view name) const;

  /// "no scene 'spere', did you mean 'sphere'? (known: box, circle, ...)".
  [[nodiscard]] std::string unknown_text(std::string_view name) const;

  /// Those that are scenes.
  [[nodiscard]] const SceneLibrary& scenes() const noexcept;

 private:
  struct Shelf;
  std::shared_ptr<Shelf> shelf_;
};

}  // namespace forcebound::server
