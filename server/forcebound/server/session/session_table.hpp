#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "forcebound/server/session/counters.hpp"
#include "forcebound/server/session/observer.hpp"
#include "forcebound/server/session/replies.hpp"
#include "forcebound/server/session/session.hpp"

namespace forcebound::server {

/// The sessions of a server, and what is left of those that their clients ended lately.
///
/// Takes sessions that are made, and reasons to close them. Gives the one of a number, or of an address and nonce. A
/// session that is closed is counted by the reason, its client and the observer are told, and the faults of its
/// environment are added to the totals.
///
/// Sessions keep their place in memory until they are closed. Looking up is real time: noexcept, no allocation; O(1) by
/// number, O(sessions) by address. Not thread-safe.
class SessionTable {
 public:
  /// All but the number must outlive this. @param most so many sessions are open without allocation; above 0
  SessionTable(std::size_t most, Replies& replies, ServerCounters& counters, ServerObserver& observer);

  /// What a client's Bye left: late motions are still counted, further copies of its Bye are answered with the updated
  /// counts, and copies of its Hello are recognised.
  struct Ended {
    std::uint64_t nonce = 0;
    net::Address address;
    Arrivals arrivals;
  };

  /// Null: there is none of that number.
  [[nodiscard]] Session* find(std::uint64_t number) noexcept;
  [[nodiscard]] Session* find(const net::Address& address, std::uint64_t nonce) noexcept;
  [[nodiscard]] Ended* find_ended(std::uint64_t number) noexcept;
  /// Whether one of that number is open or remembered.
  [[nodiscard]] bool has_or_had(std::uint64_t number) noexcept {
    return sessions_.contains(number) || find_ended(number) != nullptr;
  }
  /// Whether a client there ended the session that its Hello with this nonce had opened.
  [[nodiscard]] bool has_ended(const net::Address& address, std::uint64_t nonce) const noexcept;

  /// Whether it is about a session that another client opened. @param client a key; empty: it is not known
  [[nodiscard]] bool is_of_another(const wire::Message& message, std::string_view client) const noexcept;

  /// @param session its number is of no other. @throws std::bad_alloc
  Session& open(Session session);

  /// Sends Bye, unless the client's own ends it, or it never sent motion and nobody asked: its address may be forged.
  void close(Session& session, CloseReason reason);

  /// Closes each for which there is a reason. @returns how many
  std::size_t close_each(const std::function<std::optional<CloseReason>(const Session&)>& reason_to);

  /// A client's Bye: closes its session, and sends the final counts to its address or to one that sent at least as
  /// much. Of one that is closed, sends them again.
  /// @param bytes of the datagram
  void close_by_client(const wire::Bye& bye, std::size_t bytes, const net::Address& from);

  using Sessions = std::unordered_map<std::uint64_t, Session>;
  [[nodiscard]] Sessions& all() noexcept { return sessions_; }
  [[nodiscard]] const Sessions& all() const noexcept { return sessions_; }
  [[nodiscard]] std::size_t size() const noexcept { return sessions_.size(); }
  [[nodiscard]] std::size_t count_if(const std::function<bool(const Session&)>& condition) const;

 private:
  void count(CloseReason reason) noexcept;

  Replies& replies_;
  ServerCounters& counters_;
  ServerObserver& observer_;
  Sessions sessions_;
  std::vector<Ended> ended_;  ///< ring buffer of the latest
  std::size_t ended_next_ = 0;
};

}  // namespace forcebound::server
