#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/server/offer/environment.hpp"

namespace forcebound::server {

/// The environments that clients can request by name. One that takes long to make, such as a scene that is to be
/// compiled, is made at its first request, so that the server starts at once.
///
/// Copies share one library. Not thread-safe.
class EnvironmentLibrary {
 public:
  /// An environment that is made when it is requested.
  struct Later {
    std::string name{};
    /// Called once for each library, on any thread. @throws std::exception if it cannot be made
    std::function<EnvironmentKind()> make{};
  };

  /// What the library has of a name. All members empty: the name is unknown.
  struct Requested {
    std::shared_ptr<const EnvironmentKind> found{};
    bool coming = false;    ///< it is being made on another thread: retry later
    std::string why_not{};  ///< reason why it could not be made
  };

  EnvironmentLibrary();

  /// Another library of the same environments, for another thread, which makes its own of those that are made when
  /// requested. The others are called by all those threads.
  [[nodiscard]] EnvironmentLibrary copy() const;

  /// Replaces an environment of the same name.
  /// @throws std::invalid_argument without a name or without `make`
  void add(EnvironmentKind kind);
  void add_later(Later later);

  /// From now on `request` passes what is to be made to `elsewhere` and does not wait for it. The receiver passes the
  /// result to `store`, or the failure to `give_up`. What was passed to an earlier `elsewhere` is forgotten: the next
  /// request starts it again. With an empty function `request` makes it at once and waits.
  void make_elsewhere(std::function<void(Later)> elsewhere);
  void store(std::string_view name, EnvironmentKind made);

  /// It could not be made. The next request reports `why`; the one after retries.
  void give_up(std::string_view name, std::string why);

  /// Gives the same kind until it is replaced: clients of a shared scene must get the same one.
  /// @throws what the making threw
  [[nodiscard]] Requested request(std::string_view name) const;

  /// As `request`, but makes it now if necessary. Null if the name is unknown. Never opens files, because the name may
  /// come from a client.
  [[nodiscard]] std::shared_ptr<const EnvironmentKind> find(std::string_view name) const;

  [[nodiscard]] std::vector<std::string> names() const;

  /// "no scene 'spere', did you mean 'sphere'? (known: box, circle, ...)".
  [[nodiscard]] std::string unknown_text(std::string_view name) const;

 private:
  struct Entry;
  struct Shelf;
  [[nodiscard]] Entry& entry_for(std::string name);

  std::shared_ptr<Shelf> shelf_;
};

}  // namespace forcebound::server
