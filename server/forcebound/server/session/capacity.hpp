#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "forcebound/server/session/client_rights.hpp"
#include "forcebound/server/session/housekeeping.hpp"
#include "forcebound/server/session/server_options.hpp"
#include "forcebound/server/session/session_table.hpp"

namespace forcebound::server {

/// Whether there is room for one more session: within the limits on sessions of an address, of a client, in a shared
/// scene and of all, and on the load of the processor. Where there are other workers, for all of them together.
///
/// Takes the open sessions and the measured load. Has one that does nothing evicted where that makes room; of other
/// workers' sessions such a one is asked for. Not thread-safe.
class Capacity {
 public:
  /// All must outlive this.
  Capacity(const ServerOptions& options, SessionTable& table, Housekeeping& housekeeping,
           const ServerCounters& counters) noexcept
      : options_(options), table_(table), housekeeping_(housekeeping), counters_(counters) {}

  struct NoRoom {
    std::string text;         ///< for people
    bool place_soon = false;  ///< but another worker is ending a session for it: the client repeats its Hello
  };
  /// Nothing: there is room, if need be after an eviction. @throws std::bad_alloc
  [[nodiscard]] std::optional<NoRoom> refusal_of(const EnvironmentKind& kind, const Sender& sender, Nanoseconds now);

  /// Of a new session, among those of all workers. @throws std::runtime_error if others have taken the last one
  /// meanwhile
  [[nodiscard]] SharedLimits::Place place_for(std::uint64_t session, const Sender& sender) const;

  /// A session was opened.
  void count_opened() noexcept;

  /// Stores which share of its time the thread that serves has not waited since the last call, and how many datagrams
  /// came meanwhile: what the system takes for datagrams is in no session's share. Of that time counts as much as
  /// motions of sessions are of the datagrams, so that a flood keeps nobody out.
  void store_busy(double share, std::uint64_t datagrams) noexcept;

  /// Share of the thread's time that the sessions took lately.
  [[nodiscard]] double busy() const noexcept { return busy_; }

 private:
  /// Nothing: its client may have one more, if need be after evicting one of its own that does nothing.
  [[nodiscard]] std::optional<NoRoom> refusal_of_client(const ClientRights& rights, Nanoseconds now);
  /// Why another session in it would be one too many for the processor; empty: it would not.
  [[nodiscard]] std::string refusal_of_load(const EnvironmentKind& kind, Nanoseconds now);
  /// Among all workers' sessions. @param client places are few among its own; nothing: among all
  [[nodiscard]] bool asks_others_for_place(std::optional<std::string_view> client) const noexcept;
  [[nodiscard]] std::size_t sessions_of(const net::Address& address) const noexcept;
  [[nodiscard]] std::size_t sessions_of(std::string_view client) const noexcept;
  [[nodiscard]] std::size_t sessions_of_all() const noexcept;

  const ServerOptions& options_;
  SessionTable& table_;
  Housekeeping& housekeeping_;
  const ServerCounters& counters_;
  double busy_ = 0;                        ///< share of the thread's time for the sessions
  std::size_t busy_with_ = 0;              ///< so many sessions at once
  std::size_t sessions_since_stored_ = 0;  ///< most at once since `busy_` was stored
  std::uint64_t motions_when_stored_ = 0;
};

}  // namespace forcebound::server
