#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "forcebound/server/environment/environment.hpp"
#include "forcebound/server/environment/scene_library.hpp"

namespace forcebound::server {

/// The environments that clients can request by name: scenes, and those that a program adds.
///
/// Copies share one library. Not thread-safe.
class EnvironmentLibrary {
 public:
  EnvironmentLibrary();

  /// Every scene of that library is an environment, also a scene added later. Implicit, so that a SceneLibrary can be
  /// passed directly.
  EnvironmentLibrary(SceneLibrary scenes);

  /// Another library of the same environments, for another thread: see SceneLibrary's. What a program has added is
  /// called by all those threads.
  [[nodiscard]] EnvironmentLibrary copy() const;

  /// Replaces an environment of the same name; takes precedence over a scene of that name.
  /// @throws std::invalid_argument without a name or without `make`
  void add(EnvironmentKind kind);

  /// A scene has the same kind until it is replaced.
  [[nodiscard]] Requested<EnvironmentKind> request(std::string_view name) const;

  /// As `request`, but compiles the scene now if necessary. Null if the name is unknown.
  [[nodiscard]] std::shared_ptr<const EnvironmentKind> find(std::string_view name) const;

  /// "no scene 'spere', did you mean 'sphere'? (known: box, circle, ...)".
  [[nodiscard]] std::string unknown_text(std::string_view name) const;

  /// The scenes among them.
  [[nodiscard]] const SceneLibrary& scenes() const noexcept;

 private:
  struct Shelf;
  std::shared_ptr<Shelf> shelf_;
};

}  // namespace forcebound::server
