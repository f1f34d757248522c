#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "forcebound/net/datagram_link.hpp"
#include "forcebound/server/offer/environment_library.hpp"
#include "forcebound/server/session/admission.hpp"
#include "forcebound/server/session/answerer.hpp"
#include "forcebound/server/session/capacity.hpp"
#include "forcebound/server/session/client_rights.hpp"
#include "forcebound/server/session/counters.hpp"
#include "forcebound/server/session/housekeeping.hpp"
#include "forcebound/server/session/observer.hpp"
#include "forcebound/server/session/replies.hpp"
#include "forcebound/server/session/server_options.hpp"
#include "forcebound/server/session/session_table.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/wire/codec.hpp"

namespace forcebound::server {

/// Holds the sessions of all clients and answers their motions. Each session has its own environment. It composes these
/// parts, each of which can be used and tested without the others:
///
///     datagram --receive--> Hello   Admission decides, Capacity whether there is room, Replies tells the client
///                           motion  Answerer: a force, at `answer_next`
///                           Bye     SessionTable: the session's end
///     time -----on_timer--> Housekeeping ends sessions whose clients do nothing
///
/// - **Hello** opens a session; a copy of it, with the same nonce from the same address, belongs to the same session.
///   An environment may depend on the round trip. A Hello without it is then refused, which lets the client measure
///   it; no state is kept for that client.
/// - **Motion** is answered if it is the newest of its session. Duplicates and reordered motions are counted, and the
///   client receives the counts, so that both ends agree on losses and reordering. Motion of an unknown
///   session (the server restarted) is refused with fewer bytes than it had, which rules out amplification. The
///   session's address becomes that of its newest motion: only its client knows the session's 64-bit number. Until the
///   client has sent back a challenge from there, no more bytes are answered to it than come from it.
/// - **Bye** is answered with the final counts, as often as it arrives. The server itself sends a Bye to a client whose
///   motion stopped arriving, because datagrams to the client may still get through.
///
/// Everything is bounded: sessions, idle time, Hellos per second of each source and session, answers per second and
/// session. Time and randomness are arguments. Not thread-safe.
class Server {
 public:
  /// @param random unguessable numbers, for sessions and challenges
  /// @param observer may be null
  /// @throws std::invalid_argument if the library has no environment of the name in the options, or an option is not
  /// positive
  Server(ServerOptions options, EnvironmentLibrary environments, net::DatagramLink& link, const time::Clock& clock,
         std::function<std::uint64_t()> random, ServerObserver* observer = nullptr);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Receives a datagram that arrived at `now`. Motion waits for `answer_waiting`; a newer one of its session replaces
  /// it. Real time for motion: no allocation.
  /// @param sender its rights count for a Hello, and a session takes motions and a Bye of the client alone that opened
  /// it
  /// @returns the worker to which the datagram is to be handed over, to be received there as judged: it is a Hello
  /// within its rate for a shared scene that is there
  std::optional<std::size_t> receive(std::span<const std::byte> datagram, const Sender& sender, Nanoseconds now);

  /// Refuses a Hello that was to be handed over and could not be. @param why for people
  void refuse_hello(std::span<const std::byte> hello, const net::Address& from, std::string_view why);

  /// Answers the newest motion of each session. If all datagrams have been received before, a scene that takes longer
  /// than a tick is answered less often, but its delay does not grow. Real time: no allocation, O(objects of the
  /// scenes).
  void answer_waiting() noexcept { answerer_.answer_waiting(); }

  /// The same for the one session that has waited longest; false if none waits.
  bool answer_next() noexcept { return answerer_.answer_next(); }

  /// `receive` and `answer_waiting` for one datagram.
  void on_datagram(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now,
                   const ClientRights& rights = {});

  /// Closes idle sessions. To be called a few times a second.
  void on_timer(Nanoseconds now) { housekeeping_.on_timer(now); }

  /// From now on refuses who asks for a session, with this reason; those that are open go on.
  void admit_none(std::string why) { admission_.admit_none(std::move(why)); }

  /// Sends Bye to all clients and ends their sessions.
  void stop();

  /// Sends Bye to the clients of these sessions and ends them. The clients may ask for others. @returns how many
  std::size_t end_sessions(const std::function<bool(const Session&)>& which);

  /// Stores which share of its time the thread that serves has not waited since the last call, and how many datagrams
  /// came meanwhile.
  void store_busy(double share, std::uint64_t datagrams) noexcept { capacity_.store_busy(share, datagrams); }

  [[nodiscard]] std::size_t sessions() const noexcept { return table_.size(); }
  [[nodiscard]] ServerCounters counters() const noexcept;

  /// Share of the thread's time that the sessions took lately.
  [[nodiscard]] double busy() const noexcept { return capacity_.busy(); }

 private:
  /// @returns as `receive`
  std::optional<std::size_t> on_hello(const wire::Hello& hello, const Sender& sender, Nanoseconds now);

  ServerOptions options_;
  std::function<std::uint64_t()> random_;
  ServerObserver nobody_;
  ServerObserver& observer_;
  ServerCounters counters_;
  wire::Codec codec_;  ///< of what arrives
  Replies replies_;
  SessionTable table_;
  Housekeeping housekeeping_;
  Capacity capacity_;
  Admission admission_;
  Answerer answerer_;
};

}  // namespace forcebound::server
