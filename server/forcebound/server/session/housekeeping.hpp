#pragma once

#include <functional>
#include <optional>

#include "forcebound/server/session/server_options.hpp"
#include "forcebound/server/session/session_table.hpp"

namespace forcebound::server {

/// Closes the sessions whose clients do nothing: after the idle timeout, or earlier where another needs the place.
///
/// Takes the time and the options' timeouts. A place is needed by who asks this server (`evict_one`), or another worker
/// of its process (`on_timer`). Not thread-safe.
class Housekeeping {
 public:
  /// Both must outlive this.
  Housekeeping(const ServerOptions& options, SessionTable& table) noexcept : options_(options), table_(table) {}

  /// Closes idle sessions, and those whose places other workers want. A few times a second.
  void on_timer(Nanoseconds now);

  /// Among which sessions places are few.
  using Among = std::function<bool(const Session&)>;
  /// Closes the one that has done nothing for longest; false: all do something.
  /// @param among evict one of these, also if it sent motion but does nothing now; empty: any that never did
  [[nodiscard]] bool evict_one(Nanoseconds now, const Among& among);

 private:
  /// Since when it does nothing, where that is reason enough to give its place to another; else nothing.
  [[nodiscard]] std::optional<Nanoseconds> idle_since(const Session& session, Nanoseconds now,
                                                      bool places_are_few) const noexcept;
  /// Of one whose place another gets.
  [[nodiscard]] CloseReason reason_to_evict(const Session& session, Nanoseconds now) const noexcept;
  /// Whether another worker wants its place and it is still idle.
  [[nodiscard]] bool is_wanted_elsewhere(const Session& session, Nanoseconds now) const noexcept;

  const ServerOptions& options_;
  SessionTable& table_;
};

}  // namespace forcebound::server
