#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/net/datagram_link.hpp"
#include "forcebound/server/environment/environment_library.hpp"
#include "forcebound/server/session/counters.hpp"
#include "forcebound/server/session/observer.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/time/token_bucket.hpp"
#include "forcebound/wire/codec.hpp"
#include "forcebound/wire/sequence_window.hpp"

namespace forcebound::server {

using control::Vector;
using time::Nanoseconds;

/// Limits of a server, and what it offers. The defaults are those of forcebound-server.
struct ServerOptions {
  std::string scene = "wall";                           ///< for clients that ask for none; in the library
  std::size_t sessions_max = 64;                        ///< at once
  Nanoseconds idle_timeout = std::chrono::seconds{60};  ///< without motion; longer than any round trip (12 s are known)
  double motions_per_promised = 4;                      ///< answers per motion that the client promised in its Hello
  int hellos_per_s_max = 50;                            ///< over all clients
  control::LawRegistry laws = baselines::shipped_laws();  ///< whose server-side laws clients may request
};

/// The sessions of all clients, and the answer to each motion. Each session has an environment of its own.
///
/// - **Hello** opens a session; a copy of it, with the same nonce from the same address, belongs to the same session.
///   An environment may depend on the round trip. A Hello without it is then refused, which lets the client measure
///   it; no state is kept for that client.
/// - **Motion** is answered if it is newer than every other of its session. Duplicates and reordered motions are
///   counted, and the client is told the counts, so that both ends agree on what the network did. Motion of an unknown
///   session (the server restarted) is refused with fewer bytes than it had. The session's address becomes that of its
///   newest motion: only its client knows the session's 64-bit number.
/// - **Bye** is answered with the final counts, as often as it arrives. The server sends one itself to a client whose
///   motion stopped arriving, because the way down may still work.
///
/// A server-side law is requested by name in the Hello. It chooses the position at which the environment is evaluated,
/// and which part of the answer goes to the device; it starts anew with each session.
///
/// Everything is bounded: sessions, idle time, Hellos per second, answers per second and session. Time and randomness
/// are arguments. Not thread-safe.
class Server {
 public:
  /// @param session_ids unguessable numbers
  /// @param observer may be null
  /// @throws std::invalid_argument if the library has no environment of the name in the options, or an option is not
  /// positive
  Server(ServerOptions options, EnvironmentLibrary environments, net::DatagramLink& link, const time::Clock& clock,
         std::function<std::uint64_t()> session_ids, ServerObserver* observer = nullptr);

  /// Takes in a datagram that arrived at `now`. Motion waits for `answer_waiting`; a newer one of its session replaces
  /// it. Real time for motion: no allocation.
  void take_in(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now);

  /// Answers the newest motion of each session. If all datagrams have been taken in before, a scene that takes longer
  /// than a tick is answered less often, but never later and later. Real time: no allocation, O(objects of the scenes).
  void answer_waiting() noexcept;

  /// The same for the one session that has waited longest; false if none waits.
  bool answer_next() noexcept;

  /// Both: for one datagram at a time.
  void on_datagram(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now);

  /// Closes what is idle. To be called a few times a second.
  void on_timer(Nanoseconds now);

  /// Says Bye to all clients and forgets them.
  void stop();

  [[nodiscard]] std::size_t sessions() const noexcept { return sessions_.size(); }
  [[nodiscard]] ServerCounters counters() const noexcept;

 private:
  /// Which motions of a session came, and the counts that the client is told.
  struct Arrivals {
    wire::SequenceWindow window{};
    wire::Bye counts{};
  };

  /// A motion for its answer.
  struct Waiting {
    wire::MotionSample motion;
    Nanoseconds since;
  };

  /// The half of a client's law that stands between its motions and the environment.
  struct ServerSide {
    std::unique_ptr<control::ServerSideLaw> law;  ///< null: the law has no half here
    std::optional<Nanoseconds> answered{};        ///< device time of the motion answered last

    /// Where the environment is to be asked [m].
    [[nodiscard]] Vector place(const wire::MotionSample& motion) noexcept;
    [[nodiscard]] control::ServerSideLaw::Said answer(const Vector& force_N) noexcept;
  };

  struct Session {
    SessionInfo info;
    std::uint64_t nonce;
    std::shared_ptr<const EnvironmentKind> kind;
    MadeEnvironment made;
    ServerSide server_side;
    time::TokenBucket rate;
    Nanoseconds last_heard;
    Arrivals arrivals{};
    std::optional<Waiting> waiting{};
    bool unsound_noted = false;
  };

  /// What remains of a session that the client ended: its motion that was still on its way is counted, further copies
  /// of its Bye are answered with the counts as they are by then, and copies of its Hello are known.
  struct Ended {
    std::uint64_t nonce = 0;
    net::Address address;
    Arrivals arrivals;
  };

  void on_hello(const wire::Hello& hello, const net::Address& from, Nanoseconds now);
  void on_motion(const wire::MotionSample& motion, const net::Address& from, Nanoseconds now) noexcept;
  void on_bye(const wire::Bye& bye, const net::Address& from);

  struct Refused {
    wire::RefusalReason reason;
    std::string text;  ///< for people
  };
  void refuse(const wire::Hello& hello, const net::Address& from, const Refused& refused);

  /// None: there is room, if need be instead of somebody who never sent motion.
  [[nodiscard]] std::optional<Refused> refusal_of(const wire::Hello& hello, const EnvironmentKind& kind,
                                                  Nanoseconds now);

  /// @param kind only who is in this one; null: anybody
  [[nodiscard]] bool evict_unproven(Nanoseconds now, const EnvironmentKind* kind);
  [[nodiscard]] Session* find(const net::Address& address, std::uint64_t nonce) noexcept;
  [[nodiscard]] Ended* find_ended(std::uint64_t session) noexcept;
  wire::SequenceWindow::Arrival note(Arrivals& arrivals, std::uint64_t sequence) noexcept;
  /// Makes the environment and opens a session in it, or refuses.
  void let_in(const wire::Hello& hello, std::shared_ptr<const EnvironmentKind> kind, const net::Address& from,
              Nanoseconds now);
  Session& open(const wire::Hello& hello, std::shared_ptr<const EnvironmentKind> kind, MadeEnvironment made,
                const net::Address& from, Nanoseconds now);
  [[nodiscard]] bool is_full(const EnvironmentKind& kind) const;
  void welcome(const Session& session);
  void answer(Session& session, const Waiting& waiting) noexcept;

  /// What the environment says, or zero force where that is not finite or of wrong size.
  [[nodiscard]] Response ask(Session& session, const Motion& motion) noexcept;
  bool send(const wire::Message& message, const net::Address& to) noexcept;

  /// Tells the observer and keeps what the totals need; the caller erases.
  void close(const Session& session, CloseReason reason);

  ServerOptions options_;
  EnvironmentLibrary environments_;
  net::DatagramLink& link_;
  const time::Clock& clock_;
  std::function<std::uint64_t()> session_ids_;
  ServerObserver nobody_;
  ServerObserver& observer_;
  wire::Codec codec_;
  std::unordered_map<std::uint64_t, Session> sessions_;
  std::vector<std::uint64_t> waiting_;  ///< sessions of which some may have ended since, in the order of their motions
  std::size_t next_waiting_ = 0;        ///< of them: those before are answered
  std::vector<Ended> ended_;            ///< a ring of the last ones
  std::size_t ended_next_ = 0;
  time::TokenBucket hellos_;
  time::TokenBucket refusals_;
  ServerCounters counters_;
};

}  // namespace forcebound::server
