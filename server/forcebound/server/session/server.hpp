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

struct ServerOptions {
  std::string scene = "wall";                           ///< for clients that ask for none; in the library
  std::size_t sessions_max = 64;                        ///< at once
  Nanoseconds idle_timeout = std::chrono::seconds{60};  ///< without motion; longer than any round trip (12 s are known)
  double motions_per_promised = 4;                      ///< answers per motion that the client promised in its Hello
  int hellos_per_s_max = 50;                            ///< over all clients
  control::LawRegistry laws = baselines::shipped_laws();  ///< whose halves clients may ask for
};

/// Who is connected, and the answer to each of their motions: every client meets an environment made for its session.
///
/// Hello: the same nonce from the same address always means the same session. For an environment that depends on the
/// round trip it must tell it; who does not is answered so that it can measure it, and remembered nowhere. Motion: if
/// newer than every other of its session it is answered; copies and latecomers are counted, in the session too, so that
/// client and server agree on what the network did. Motion of an unknown session (the server restarted) is refused at
/// once with fewer bytes than it had. A session follows its client to another address if the newest motion comes from
/// there, because nobody else knows its 64-bit number. Bye: answered with the final counts, and again if the answer was
/// lost; sent as well to a client that was there and fell silent, because perhaps only the way up has died.
///
/// A law that has a half here is asked for by name in the Hello. That half chooses where the environment is asked, and
/// what of its answer goes to the device; it begins anew with each session.
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

  /// Whatever came from the network; `now` is when it came. Motion waits for `answer_waiting`, and a newer one of its
  /// session takes its place. Real time for motion: no allocation.
  void take_in(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now);

  /// Answers the newest motion of each session. Whoever reads all that has come before calling it never falls behind: a
  /// scene that takes longer than a tick is felt less often, not later and later. Real time: no allocation, O(objects
  /// of the scenes).
  void answer_waiting() noexcept;

  /// The same for one session, who waited longest; false if nobody waits any more.
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
