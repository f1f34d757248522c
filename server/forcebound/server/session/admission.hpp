#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "forcebound/server/offer/environment_library.hpp"
#include "forcebound/server/session/capacity.hpp"
#include "forcebound/server/session/client_rights.hpp"
#include "forcebound/server/session/memory_budget.hpp"
#include "forcebound/server/session/replies.hpp"
#include "forcebound/server/session/server_options.hpp"
#include "forcebound/server/session/session_table.hpp"
#include "forcebound/server/session/shared_limits.hpp"

namespace forcebound::server {

/// Not to be answered: it is counted, and a client whose scene or place comes soon repeats it.
struct Unanswered {};

/// Its scene is shared, and at that worker.
struct Elsewhere {
  std::size_t worker;
};

/// Its environment depends on the round trip, which the client has not measured.
struct RoundTripWanted {};

/// The client has a session.
struct LetIn {
  const Session& session;
  bool repeated;  ///< the Hello is a copy of the one that opened it
};

/// What becomes of a Hello.
using Decision = std::variant<Unanswered, Elsewhere, RoundTripWanted, Refused, LetIn>;

/// Decides who may have a session, and opens it.
///
/// Takes Hellos, and the rights of who sent them. A Hello must be within the rate of its source or client, speak our
/// protocol version, ask for a scene that this server offers and its client may use, by a device and a law that go with
/// the scene; there must be room for another session (capacity.hpp), and memory for its environment
/// (memory_budget.hpp). Lack of memory does not touch the other sessions.
///
/// Sends nothing of its own: a session that it has evicted is closed by the table. Not thread-safe.
class Admission {
 public:
  struct Parts {
    SessionTable& table;
    Capacity& capacity;
    ServerCounters& counters;
    const std::function<std::uint64_t()>& random;  ///< unguessable numbers
  };
  /// All must outlive this. @param now of the server's clock
  Admission(const ServerOptions& options, EnvironmentLibrary environments, const Parts& parts, Nanoseconds now);

  /// @throws std::bad_alloc; nothing was opened then
  [[nodiscard]] Decision decide(const wire::Hello& hello, const Sender& sender, Nanoseconds now);

  /// From now on refuses who asks for a session, with this reason.
  void admit_none(std::string why) { admits_none_ = std::move(why); }

 private:
  /// Whether it is one too many, or late: counted, and not looked at.
  [[nodiscard]] bool is_dropped(const wire::Hello& hello, const Sender& sender, Nanoseconds now) noexcept;
  [[nodiscard]] bool is_over_rate(const Sender& sender, Nanoseconds now) noexcept;
  /// Nothing: it may ask for this scene. Before the scene would be compiled.
  [[nodiscard]] std::optional<Refused> refusal_to_ask(const wire::Hello& hello, const ClientRights& rights,
                                                      std::string_view scene);
  /// Nothing: device and law go with the environment.
  [[nodiscard]] std::optional<Refused> refusal_of_device(const wire::Hello& hello, const EnvironmentKind& kind) const;
  /// Of one that may ask for the environment.
  [[nodiscard]] Decision decide_place(const wire::Hello& hello, std::shared_ptr<const EnvironmentKind> kind,
                                      const Sender& sender, Nanoseconds now);
  /// Makes the environment and opens a session in it, if there is memory for both.
  [[nodiscard]] Decision let_in(const wire::Hello& hello, std::shared_ptr<const EnvironmentKind> kind,
                                const Sender& sender, Nanoseconds now);
  const Session& open(const wire::Hello& hello, std::shared_ptr<const EnvironmentKind> kind, MadeEnvironment made,
                      const Sender& sender, Nanoseconds now);
  [[nodiscard]] std::uint64_t new_session_number();
  /// Whether clients may request it, whatever the library has. @param scene empty: the default
  [[nodiscard]] bool is_offered(std::string_view scene) const;
  [[nodiscard]] std::string refusal_of_scene(std::string_view scene) const;

  const ServerOptions& options_;
  EnvironmentLibrary environments_;
  Parts parts_;
  MemoryBudget memory_;
  std::string admits_none_;  ///< why; empty: it does
  HelloRate hellos_;
};

}  // namespace forcebound::server
