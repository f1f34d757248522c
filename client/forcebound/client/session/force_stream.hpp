#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "forcebound/client/session/blackout_watch.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/wire/messages.hpp"
#include "forcebound/wire/sequence_window.hpp"

namespace forcebound::client {

using time::Nanoseconds;

/// The motions sent, the forces that answered them, and what became of the rest.
///
/// Trusts nothing that arrives: a force counts only if it belongs to this session, answers a motion that was sent,
/// echoes that motion's time and holds numbers that can be what they say; a server that has heard or said more than was
/// sent is not believed. The newest is the one that answers the newest motion.
///
/// Real time: noexcept, no allocation after construction, O(1).
class ForceStream {
 public:
  enum class Verdict : std::uint8_t {
    newest,
    reordered,    ///< genuine, but a force for a newer motion came before it
    duplicate,    ///< a further copy
    foreign,      ///< of another session
    implausible,  ///< answers nothing that was sent
  };

  struct Counts {
    std::uint64_t sent = 0;        ///< motions
    std::uint64_t received = 0;    ///< distinct forces
    std::uint64_t duplicated = 0;  ///< further copies of forces
    std::uint64_t reordered = 0;   ///< forces that came after one for a newer motion
    std::uint64_t foreign = 0;
    std::uint64_t implausible = 0;
    std::uint64_t lost_up = 0;             ///< motions that the server has not seen, as far as is known
    std::uint64_t lost_down = 0;           ///< forces sent that have not arrived
    std::uint64_t in_flight = 0;           ///< of `lost_up`: may still be on their way, or their answers
    std::uint64_t unanswered = 0;          ///< motions that the server has received and not answered
    std::uint64_t motions_duplicated = 0;  ///< at the server
    std::uint64_t motions_reordered = 0;   ///< at the server, which does not answer those
  };

  explicit ForceStream(int degrees_of_freedom);

  /// Another session begins: its server counts from nothing. Motions keep their numbers, and the newest force stays
  /// until a newer one comes.
  void begin_session(std::uint64_t session) noexcept;

  /// The number of the motion that is sent now, 1, 2, 3, ...
  std::uint64_t note_sent(Nanoseconds reading_time) noexcept;

  /// The network did not even take it: it is not lost, it was never sent.
  void note_not_sent() noexcept { --sent_here_; }

  /// @param arrival by the clock of the reading times
  Verdict accept(const wire::EnvironmentForce& force, Nanoseconds arrival) noexcept;

  /// The server's last word on this session. False if it is of another one.
  bool accept(const wire::Bye& bye) noexcept;

  [[nodiscard]] const std::optional<wire::EnvironmentForce>& newest() const noexcept { return newest_; }

  /// When the motion that `force` answers was read.
  [[nodiscard]] static Nanoseconds reading_time(const wire::EnvironmentForce& force) noexcept {
    return force.motion_device_time;
  }

  /// This session's, as of the newest force.
  [[nodiscard]] Progress progress() const noexcept { return progress_at(newest_ ? newest_->motion_sequence : 0); }

  /// This session's, as of the server's last word on it.
  [[nodiscard]] Progress final_progress() const noexcept { return progress_at(sequence_); }

  /// How long this session's network has held a datagram up: the longest round trip of a force, and beside it how late
  /// the latest motion came after newer ones. What has not come after so long is lost, as far as this can be told.
  [[nodiscard]] Nanoseconds longest_delay(Nanoseconds period) const noexcept;

  /// Over all sessions. Whatever is still on its way counts as lost. Each motion has one fate:
  ///
  ///     sent = received + unanswered + lost_up + lost_down
  ///
  /// In flight are those of this session that are newer than the newest answered and no older at `now` than the longest
  /// round trip: there has been no time yet for the server's count of them to come.
  [[nodiscard]] Counts counts(Nanoseconds now) const noexcept;

 private:
  [[nodiscard]] Counts settled_counts() const noexcept;
  [[nodiscard]] std::uint64_t in_flight(Nanoseconds now) const noexcept;
  void note_server_counts(const wire::Bye& counts) noexcept;

  /// Whether a server can have heard and said so much: more than was sent, or more answers than motions, would spoil
  /// the counts of what was lost.
  [[nodiscard]] bool can_count(std::uint64_t motions_received, std::uint64_t forces_sent) const noexcept {
    return motions_received <= sent_here_ && forces_sent <= motions_received;
  }
  [[nodiscard]] Progress progress_at(std::uint64_t motion) const noexcept {
    return {session_, motion, server_.motions_received, server_.forces_sent, received_};
  }

  struct Sent {
    std::uint64_t sequence = 0;
    Nanoseconds time{0};
    std::uint64_t before = 0;  ///< sent in its session before it
  };

  int degrees_of_freedom_;
  std::uint64_t sequence_ = 0;
  std::vector<Sent> sent_;  // a ring over the last motions
  std::optional<wire::EnvironmentForce> newest_;

  std::uint64_t session_ = 0;
  wire::SequenceWindow arrivals_;
  wire::Bye server_;             // the server's counts so far, this session
  std::uint64_t sent_here_ = 0;  // this session
  std::uint64_t received_ = 0;   // this session
  std::uint64_t settled_ = 0;    // number of the newest motion answered, or of the last before this session
  Nanoseconds round_trip_{0};    // the longest, this session
  Counts ended_;                 // of sessions that are over, and what belongs to none
};

}  // namespace forcebound::client
