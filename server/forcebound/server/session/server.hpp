#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/net/datagram_link.hpp"
#include "forcebound/server/environment/environment_library.hpp"
#include "forcebound/server/session/anti_amplification_limit.hpp"
#include "forcebound/server/session/client_rights.hpp"
#include "forcebound/server/session/compute_share.hpp"
#include "forcebound/server/session/counters.hpp"
#include "forcebound/server/session/memory_budget.hpp"
#include "forcebound/server/session/observer.hpp"
#include "forcebound/server/session/scene_sender.hpp"
#include "forcebound/server/session/shared_limits.hpp"
#include "forcebound/server/session/view_sender.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/time/sequence_window.hpp"
#include "forcebound/time/token_bucket.hpp"
#include "forcebound/wire/codec.hpp"

namespace forcebound::server {

using control::Vector;
using time::Nanoseconds;

/// A server's limits, default scene and server-side laws. The defaults are those of forcebound-server.
struct ServerOptions {
  std::string scene = "wall";            ///< for clients that request none; must be in the library
  std::vector<std::string> scenes{};     ///< that clients may request, besides `scene`; empty: all of the library
  std::size_t sessions_max = 64;         ///< at once
  std::size_t sessions_per_address = 0;  ///< at once, of an IP address whatever the port; 0: no such limit
  Nanoseconds idle_timeout =
      std::chrono::seconds{60};  ///< without motion; must exceed any round trip (12 s has been observed)
  /// Without motion for so long, a client loses its place in a shared scene to one who asks for it while it is full.
  Nanoseconds presence_timeout = std::chrono::seconds{20};
  /// Its device not moved by more than 1 mm for so long, it does too, although its motions arrive.
  Nanoseconds stillness_timeout = std::chrono::seconds{60};
  double motions_per_promised = 4;  ///< answers per motion that the client promised in its Hello
  double session_compute_max =
      0.5;                    ///< share of the server's thread that answers of one session may take beside others
  double load_max = 0.9;      ///< share of the server's thread above which nobody more is let in
  int hellos_per_s_max = 50;  ///< from each source: an IPv4 address or IPv6 network
  MemoryLimits memory{};
  HandoverRate handover{};                                ///< of scenes, to each client that renders locally
  ViewRate view{};                                        ///< of pictures, to clients that ask
  WorkerPlace worker{};                                   ///< among the servers of this process
  control::LawRegistry laws = baselines::shipped_laws();  ///< the laws whose server-side law clients can request
};

/// Holds the sessions of all clients and answers their motions. Each session has its own environment.
///
/// - **Hello** opens a session; a copy of it, with the same nonce from the same address, belongs to the same session.
///   An environment may depend on the round trip. A Hello without it is then refused, which lets the client measure
///   it; no state is kept for that client.
/// - **Motion** is answered if it is the newest of its session. Duplicates and reordered motions are counted, and the
///   client receives the counts, so that both ends agree on losses and reordering. Motion of an unknown
///   session (the server restarted) is refused with fewer bytes than it had, which rules out amplification. The
///   session's address becomes that of its newest motion: only its client knows the session's 64-bit number. Until the
///   client has sent back a challenge from there, no more bytes are answered to it than come from it.
///   A motion whose number is further ahead than the client can have sent since the newest is dropped: a single forged
///   one would make old ones of all that follow.
/// - **Bye** is answered with the final counts, as often as it arrives. The server itself sends a Bye to a client whose
///   motion stopped arriving, because datagrams to the client may still get through.
///
/// A server-side law is requested by name in the Hello. It chooses the position at which the environment is evaluated,
/// and the force that is sent to the device; each session has a new instance.
///
/// A session for which there is no memory, or whose environment takes more than is allowed, is refused with that
/// reason, and does not touch the others.
///
/// No session's answers take more than their share of the processor while there are others: motions beyond that are
/// counted and not answered. Who asks for a session is refused, with that reason, if answers to it and the others would
/// take more than the server has.
///
/// Everything is bounded: sessions, idle time, Hellos per second of each source and session, answers per second and
/// session. Time and randomness are arguments. Not thread-safe.
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
  /// @param rights of who sent it; they count for a Hello, and a session takes motions and a Bye of the client alone
  /// that opened it
  void take_in(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now,
               const ClientRights& rights = {});

  /// `take_in` of a Hello that another worker's server took in, for a shared scene that is here: it has counted it and
  /// found it within its rate.
  void take_in_judged(std::span<const std::byte> hello, const net::Address& from, Nanoseconds now,
                      const ClientRights& rights = {});

  /// The worker to which the datagram taken in last is to be handed over, with `take_in_judged`: it is a Hello within
  /// its rate for a shared scene that is there.
  [[nodiscard]] std::optional<std::size_t> take_elsewhere() noexcept { return std::exchange(elsewhere_, std::nullopt); }

  /// Refuses a Hello that was to be handed over and could not be. @param why for people
  void refuse_hello(std::span<const std::byte> hello, const net::Address& from, std::string_view why);

  /// Answers the newest motion of each session. If all datagrams have been taken in before, a scene that takes longer
  /// than a tick is answered less often, but its delay does not grow. Real time: no allocation, O(objects of the
  /// scenes).
  void answer_waiting() noexcept;

  /// The same for the one session that has waited longest; false if none waits.
  bool answer_next() noexcept;

  /// `take_in` and `answer_waiting` for one datagram.
  void on_datagram(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now,
                   const ClientRights& rights = {});

  /// Closes idle sessions. To be called a few times a second.
  void on_timer(Nanoseconds now);

  /// From now on refuses who asks for a session, with this reason; those that are open go on.
  void admit_none(std::string why) { admits_none_ = std::move(why); }

  /// Sends Bye to all clients and ends their sessions.
  void stop();

  /// Sends Bye to a client and ends its session; false: there is none of that number. The client may ask for another.
  bool end_session(std::uint64_t session);

  /// The same for all sessions of clients that are known and whose keys do not fulfil the condition.
  /// @returns how many
  std::size_t end_sessions_unless(const std::function<bool(std::string_view key)>& may_stay);

  /// Tells which share of its time the thread that serves has not waited since the last call, and how many datagrams
  /// came meanwhile: what the system takes for datagrams is in no session's share. Of that time counts as much as
  /// motions of sessions are of the datagrams, so that a flood keeps nobody out.
  void note_busy(double share, std::uint64_t datagrams) noexcept;

  [[nodiscard]] std::size_t sessions() const noexcept { return sessions_.size(); }
  [[nodiscard]] ServerCounters counters() const noexcept;

  /// Share of the thread's time that the sessions took lately.
  [[nodiscard]] double busy() const noexcept { return busy_; }

 private:
  /// The motions of a session that arrived, and the counts sent to the client.
  struct Arrivals {
    time::SequenceWindow window{};
    wire::Bye counts{};
    double motions_per_s_max = 0;   ///< of the client that keeps its promise, times what the options allow
    Nanoseconds newest_arrived{0};  ///< the newest motion
  };

  /// A motion that waits for its answer.
  struct Waiting {
    wire::MotionSample motion;
    Nanoseconds since;
  };

  /// The server-side law of a client, between its motions and the environment.
  struct ServerSide {
    std::unique_ptr<control::ServerSideLaw> law;  ///< null: the client's law has none
    std::optional<Nanoseconds> answered{};        ///< device time of the motion answered last

    /// The position at which the environment is evaluated [m].
    [[nodiscard]] Vector place(const wire::MotionSample& motion) noexcept;
    [[nodiscard]] control::ServerSideLaw::Said answer(const Vector& force_N) noexcept;
  };

  struct Session {
    SessionInfo info;
    std::uint64_t nonce;
    std::shared_ptr<const EnvironmentKind> kind;
    MadeEnvironment made;
    SharedLimits::Place place;  ///< none, where there are no other workers
    ServerSide server_side;
    time::TokenBucket rate;
    time::TokenBucket hellos;  ///< repeated ones
    Nanoseconds last_heard;
    Nanoseconds last_moved;
    Vector stays_at{};       ///< no place from then on was far from it; no rows: no motion came
    net::Address proven_at;  ///< the last address that was proven
    ComputeShare compute;
    AntiAmplificationLimit amplification{};
    Arrivals arrivals{};
    std::optional<Waiting> waiting{};
    std::string client{};                   ///< the key of who opened it; empty: it is not known
    std::unique_ptr<SceneSender> sender{};  ///< null: nothing is handed over
    std::unique_ptr<ViewSender> view{};     ///< null: its client shows nothing
    bool wants_models = false;              ///< its client renders locally
    bool unsound_noted = false;
  };

  /// Record of a session that the client ended: late motions are still counted, further copies of its Bye are answered
  /// with the updated counts, and copies of its Hello are recognised.
  struct Ended {
    std::uint64_t nonce = 0;
    net::Address address;
    Arrivals arrivals;
  };

  /// Who says Hello, and what it may do.
  struct Guest {
    const net::Address& address;
    const ClientRights& rights;
    bool judged = false;  ///< another worker has found its Hello within its rate
  };
  void take_in(std::span<const std::byte> datagram, const Guest& from, Nanoseconds now);
  void on_hello(const wire::Hello& hello, const Guest& guest, Nanoseconds now);
  /// @param bytes of the datagram
  void on_motion(const wire::MotionSample& motion, std::size_t bytes, const net::Address& from,
                 Nanoseconds now) noexcept;
  void on_bye(const wire::Bye& bye, std::size_t bytes, const net::Address& from);
  /// Whether it still has its place for a reason.
  static void note_place(Session& session, const Vector& position, Nanoseconds now) noexcept;
  /// The newest motion came from there.
  void follow(Session& session, const wire::MotionSample& motion, std::size_t bytes, const net::Address& from) noexcept;
  [[nodiscard]] std::uint64_t new_challenge() noexcept;
  /// Sends the final counts to the client's address, or to one that sent at least as much.
  void answer_bye(const wire::Bye& counts, std::size_t bytes, const net::Address& from, const net::Address& proven_at);
  /// Whether it is about a session that another client opened.
  [[nodiscard]] bool is_of_another(const wire::Message& message, const ClientRights& rights) const noexcept;
  /// Drops what can be dropped by its heading: a flood of it must cost little.
  [[nodiscard]] bool is_dropped(const wire::Heading& heading, std::size_t bytes, const net::Address& from,
                                Nanoseconds now) noexcept;

  struct Refused {
    wire::RefusalReason reason;
    std::string text;         ///< for people
    bool place_soon = false;  ///< but another worker is ending a session for it: the client repeats its Hello
  };
  void refuse(const wire::Hello& hello, const net::Address& from, const Refused& refused);

  /// None: there is room, if need be after evicting a session that never sent motion, or one that does nothing in a
  /// shared scene or among those that its client may have. Of other workers' sessions such a one is asked for.
  [[nodiscard]] std::optional<Refused> refusal_of(const wire::Hello& hello, const EnvironmentKind& kind,
                                                  const Guest& guest, Nanoseconds now);

  /// None: its client may have one more, if need be after evicting one of its own that does nothing.
  [[nodiscard]] std::optional<Refused> refusal_of_client(const ClientRights& rights, Nanoseconds now);

  /// Among which sessions places are few.
  using Among = std::function<bool(const Session&)>;
  /// @param among evict one of these, also if it sent motion but does nothing now; empty: any that never did
  [[nodiscard]] bool evict_one(Nanoseconds now, const Among& among);
  /// Among all workers' sessions. @param client places are few among its own; nothing: among all
  [[nodiscard]] bool asks_others_for_place(std::optional<std::string_view> client) noexcept;
  using Sessions = std::unordered_map<std::uint64_t, Session>;
  /// Its client or another gets its place.
  void give_up_place(const Session& session, Nanoseconds now);
  /// Whether another worker wants its place and it is still idle.
  [[nodiscard]] bool is_wanted_elsewhere(const Session& session, Nanoseconds now) noexcept;
  /// Since when it does nothing, where that is reason enough to give its place to another; else nothing.
  [[nodiscard]] std::optional<Nanoseconds> idle_since(const Session& session, Nanoseconds now,
                                                      bool places_are_few) const noexcept;
  [[nodiscard]] Session* find(const net::Address& address, std::uint64_t nonce) noexcept;
  [[nodiscard]] Ended* find_ended(std::uint64_t session) noexcept;
  time::SequenceWindow::Arrival note(Arrivals& arrivals, std::uint64_t sequence, Nanoseconds now) noexcept;
  void refuse_for_lack_of_memory(const wire::Hello& hello, const net::Address& from) noexcept;
  /// Makes the environment and opens a session in it, or refuses.
  void let_in(const wire::Hello& hello, std::shared_ptr<const EnvironmentKind> kind, const Guest& guest,
              Nanoseconds now);
  Session& open(const wire::Hello& hello, std::shared_ptr<const EnvironmentKind> kind, MadeEnvironment made,
                const Guest& guest, Nanoseconds now);
  /// Why another session in it would be one too many for the processor; empty: it would not.
  [[nodiscard]] std::string refusal_of_load(const EnvironmentKind& kind, Nanoseconds now);
  /// Whether clients may request it, whatever the library has. @param scene empty: the default
  [[nodiscard]] bool is_allowed(std::string_view scene) const;
  [[nodiscard]] std::string refusal_of_scene(std::string_view scene) const;
  [[nodiscard]] std::size_t sessions_of(const net::Address& address) const noexcept;
  [[nodiscard]] std::size_t sessions_of(std::string_view client) const noexcept;
  [[nodiscard]] std::size_t sessions_of_all() const noexcept;
  [[nodiscard]] std::size_t sessions_among(const Among& among) const;
  [[nodiscard]] std::uint64_t new_session_number();
  /// Among those of all workers. @throws std::runtime_error if others have taken the last one meanwhile
  [[nodiscard]] SharedLimits::Place place_for(std::uint64_t session, const Guest& guest);
  [[nodiscard]] bool hello_is_over_rate(const Guest& guest, Nanoseconds now) noexcept;
  void welcome(const Session& session);
  void answer(Session& session, const Waiting& waiting) noexcept;
  void hand_over(Session& session, const wire::MotionSample& motion, Nanoseconds now) noexcept;
  void show(Session& session, Nanoseconds now) noexcept;

  /// The environment's response, or zero force if it is not finite or of wrong size.
  [[nodiscard]] Response ask(Session& session, const Motion& motion) noexcept;
  /// What of its local model can be sent.
  [[nodiscard]] local_model::LocalModel model_of(const Session& session, const Response& response) noexcept;
  bool send(const wire::Message& message, const net::Address& to) noexcept {
    return send_encoded(codec_.encode(message), to);
  }
  bool send_encoded(std::span<const std::byte> datagram, const net::Address& to) noexcept;

  /// Notifies the observer and adds the session's faults to the totals; the caller erases the session.
  void close(const Session& session, CloseReason reason);

  ServerOptions options_;
  EnvironmentLibrary environments_;
  net::DatagramLink& link_;
  const time::Clock& clock_;
  std::function<std::uint64_t()> session_ids_;
  ServerObserver nobody_;
  ServerObserver& observer_;
  wire::Codec codec_;
  Sessions sessions_;
  std::vector<std::uint64_t> waiting_;  ///< session numbers in the order of their motions; some may have ended since
  std::size_t next_waiting_ = 0;        ///< index into waiting_; those before it are answered
  std::vector<Ended> ended_;            ///< ring buffer of the latest
  std::size_t ended_next_ = 0;
  MemoryBudget memory_;
  std::string admits_none_;  ///< why; empty: it does
  std::optional<std::size_t> elsewhere_{};
  HelloRate hellos_;
  time::TokenBucket refusals_;
  time::TokenBucket views_;               ///< pieces of pictures
  double busy_ = 0;                       ///< share of the thread's time for the sessions
  std::size_t busy_with_ = 0;             ///< so many sessions at once
  std::size_t sessions_since_noted_ = 0;  ///< most at once since `busy_` was noted
  std::uint64_t motions_when_noted_ = 0;
  ServerCounters counters_;
};

}  // namespace forcebound::server
