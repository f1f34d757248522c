#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "forcebound/local_model/local_model.hpp"
#include "forcebound/net/datagram_link.hpp"
#include "forcebound/server/session/replies.hpp"
#include "forcebound/server/session/server_options.hpp"
#include "forcebound/server/session/session_table.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/time/token_bucket.hpp"

namespace forcebound::server {

/// Answers motions with forces: the newest motion of each session, in the order in which they came.
///
/// Takes the motions of the table's sessions. Gives force datagrams, each with what the environment says at the place
/// that the server-side law chose, and behind them pieces of the scene and of its looks. Motions that are not answered
/// are counted by reason: no session's answers take more than their share of the processor while there are others.
///
/// Real time: noexcept, no allocation, O(objects of the scene) for an answer. Not thread-safe.
class Answerer {
 public:
  struct Parts {
    SessionTable& table;
    Replies& replies;
    ServerCounters& counters;
    ServerObserver& observer;
    const time::Clock& clock;
    const std::function<std::uint64_t()>& random;  ///< unguessable numbers
  };
  /// All must outlive this.
  Answerer(const ServerOptions& options, const Parts& parts);

  /// Counts a motion; if it is the newest of its session and within its rate, it waits for `answer_next`, and the
  /// session's address becomes the motion's. @param bytes of the datagram
  void receive(const wire::MotionSample& motion, std::size_t bytes, const net::Address& from, Nanoseconds now) noexcept;

  /// Refuses a motion of an unknown session. @param session as the motion says. @param bytes of the datagram
  void refuse(std::uint64_t session, std::size_t bytes, const net::Address& from, Nanoseconds now) noexcept;

  /// Answers the one that has waited longest; false if none waits.
  bool answer_next() noexcept;
  /// Answers all of them.
  void answer_waiting() noexcept;

 private:
  /// The newest motion came from there.
  void follow(Session& session, const wire::MotionSample& motion, std::size_t bytes, const net::Address& from) noexcept;
  [[nodiscard]] std::uint64_t new_challenge() noexcept;
  void answer(Session& session, const WaitingMotion& waiting) noexcept;
  /// The environment's answer, or zero force if it is unsound.
  [[nodiscard]] Answer ask(Session& session, const Motion& motion) noexcept;
  /// Leaves out what is not to be sent to the session's client.
  void trim(const Session& session, Answer& answer) noexcept;
  void hand_over(Session& session, const wire::MotionSample& motion, Nanoseconds now) noexcept;
  void show(Session& session, Nanoseconds now) noexcept;

  Parts parts_;
  time::TokenBucket refusals_;
  time::TokenBucket views_;             ///< pieces of pictures
  std::vector<std::uint64_t> waiting_;  ///< session numbers in the order of their motions; some may have ended since
  std::size_t next_waiting_ = 0;        ///< index into waiting_; those before it are answered
};

}  // namespace forcebound::server
