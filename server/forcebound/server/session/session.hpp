#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "forcebound/control/server_side_law.hpp"
#include "forcebound/server/offer/environment.hpp"
#include "forcebound/server/session/anti_amplification_limit.hpp"
#include "forcebound/server/session/compute_share.hpp"
#include "forcebound/server/session/counters.hpp"
#include "forcebound/server/session/observer.hpp"
#include "forcebound/server/session/scene_sender.hpp"
#include "forcebound/server/session/shared_limits.hpp"
#include "forcebound/server/session/view_sender.hpp"
#include "forcebound/time/sequence_window.hpp"
#include "forcebound/time/token_bucket.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::server {

using control::Vector;

/// The motions of a session that arrived, and the counts sent to the client. Real time: noexcept, no allocation.
struct Arrivals {
  time::SequenceWindow window{};
  wire::Bye counts{};
  double motions_per_s_max = 0;   ///< of the client that keeps its promise, times what the options allow
  Nanoseconds newest_arrived{0};  ///< the newest motion

  /// Counts a motion here and in the server's totals. One whose number is further ahead of the newest than the client
  /// can have sent since changes nothing.
  time::SequenceWindow::Arrival count(std::uint64_t sequence, Nanoseconds now, ServerCounters& totals) noexcept;
};

/// The server-side law of a client, between its motions and the environment. Real time: noexcept, no allocation.
struct ServerSide {
  std::unique_ptr<control::ServerSideLaw> law;  ///< null: the client's law has none
  std::optional<Nanoseconds> answered{};        ///< device time of the motion answered last

  /// The position at which the environment is evaluated [m].
  [[nodiscard]] Vector place(const wire::MotionSample& motion) noexcept;
  [[nodiscard]] control::ServerSideLaw::Reply answer(const Vector& force_N) noexcept;
};

/// A motion that waits for its answer.
struct WaitingMotion {
  wire::MotionSample motion;
  Nanoseconds since;
};

/// All that the server keeps of one client from its Hello to its end.
struct Session {
  SessionInfo info;
  std::uint64_t nonce;
  std::shared_ptr<const EnvironmentKind> kind;
  MadeEnvironment made;
  SharedLimits::Place place;  ///< none, where there are no other workers
  ServerSide server_side;
  time::TokenBucket rate;
  time::TokenBucket hellos;  ///< repeated ones
  Nanoseconds last_received;
  Nanoseconds last_moved;
  Vector stays_at{};       ///< no place from then on was far from it; no rows: no motion came
  net::Address proven_at;  ///< the last address that was proven
  ComputeShare compute;
  AntiAmplificationLimit amplification{};
  Arrivals arrivals{};
  std::optional<WaitingMotion> waiting{};
  std::string client{};                   ///< the key of who opened it; empty: it is not known
  std::unique_ptr<SceneSender> sender{};  ///< null: nothing is handed over
  std::unique_ptr<ViewSender> view{};     ///< null: its client shows nothing
  bool wants_models = false;              ///< its client renders locally
  bool unsound_reported = false;

  /// A real client sends motion at once; one that never did may have a forged address.
  [[nodiscard]] bool has_sent_motion() const noexcept { return arrivals.counts.motions_received > 0; }

  /// Where its device is, of its newest motion: whether it has moved, and so still has its place for a reason.
  void store_place(const Vector& position, Nanoseconds now) noexcept;
};

}  // namespace forcebound::server
