#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "forcebound/client/session/outage_detector.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/time/sequence_window.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::client {

using time::Nanoseconds;

/// Matches forces to the motions that they answer, and counts losses in both directions.
///
/// A force is accepted only if it belongs to this session, answers a motion that was sent, echoes that motion's time,
/// and its numbers are plausible: in range, and with no more motions received than were sent. The newest force is the
/// one that answers the newest motion.
///
/// Real time: noexcept, no allocation after construction; O(1) but for `counts`, O(log n), and for accepting a Bye,
/// O(n), with n the motions of the last minute.
class ForceStream {
 public:
  enum class Verdict : std::uint8_t {
    newest,
    reordered,    ///< valid, but a force for a newer motion came before it
    duplicate,    ///< a further copy
    foreign,      ///< of another session
    implausible,  ///< answers no motion that was sent, or has impossible numbers
  };

  struct Counts {
    std::uint64_t sent = 0;        ///< motions
    std::uint64_t received = 0;    ///< distinct forces
    std::uint64_t duplicated = 0;  ///< further copies of forces
    std::uint64_t reordered = 0;   ///< forces that came after one for a newer motion
    std::uint64_t foreign = 0;
    std::uint64_t implausible = 0;
    std::uint64_t lost_up = 0;             ///< motions that the server has not received, by its latest count
    std::uint64_t lost_down = 0;           ///< forces sent that have not arrived
    std::uint64_t in_flight = 0;           ///< of `lost_up`: motions that, or whose answers, may still be on their way
    std::uint64_t unanswered = 0;          ///< motions that the server has received and not answered
    std::uint64_t motions_duplicated = 0;  ///< at the server
    std::uint64_t motions_reordered = 0;   ///< at the server, which does not answer those
  };

  explicit ForceStream(int degrees_of_freedom);

  /// Begins another session: its server counts from zero. Motions keep their numbers, and the newest force stays
  /// until a newer one comes.
  void begin_session(std::uint64_t session) noexcept;

  /// The number of the motion that is sent now, 1, 2, 3, ...
  std::uint64_t count_sent(Nanoseconds reading_time) noexcept;

  /// The send failed: the motion was never sent, so it is not lost.
  void uncount_sent() noexcept { --sent_here_; }

  /// @param arrival by the clock of the reading times
  Verdict accept(const wire::EnvironmentForce& force, Nanoseconds arrival) noexcept;

  /// Takes the server's final counts of this session. False if they are of another session.
  bool accept(const wire::Bye& bye) noexcept;

  [[nodiscard]] const std::optional<wire::EnvironmentForce>& newest() const noexcept { return newest_; }

  /// When that arrived; zero: there is none.
  [[nodiscard]] Nanoseconds newest_arrival() const noexcept { return newest_arrival_; }

  /// When the motion that `force` answers was read.
  [[nodiscard]] static Nanoseconds reading_time(const wire::EnvironmentForce& force) noexcept {
    return force.motion_device_time;
  }

  /// This session's progress as of the newest force.
  [[nodiscard]] Progress progress() const noexcept { return progress_at(newest_ ? newest_->motion_sequence : 0); }

  /// This session's progress as of the server's final counts.
  [[nodiscard]] Progress final_progress() const noexcept { return progress_at(sequence_); }

  /// Longest delay that this session has seen: the longest round trip of a force, plus the largest lateness of a motion
  /// that arrived after newer ones. A datagram that is still missing after this time is taken for lost.
  [[nodiscard]] Nanoseconds longest_delay() const noexcept { return round_trip_ + lateness_; }

  /// Counts over all sessions. A motion or force still on its way counts as lost. Each motion is counted once:
  ///
  ///     sent = received + unanswered + lost_up + lost_down
  ///
  /// In flight are those of this session that are newer than the newest answered and no older at `now` than the longest
  /// round trip: there has been no time yet for the server's count of them to come.
  [[nodiscard]] Counts counts(Nanoseconds now) const noexcept;

 private:
  [[nodiscard]] Counts settled_counts() const noexcept;
  [[nodiscard]] std::uint64_t in_flight(Nanoseconds now) const noexcept;
  [[nodiscard]] std::uint64_t oldest_known() const noexcept;
  [[nodiscard]] Nanoseconds longest_time_between(std::uint64_t motions) const noexcept;
  void store_server_counts(const wire::Bye& counts) noexcept;

  /// Whether the server's counts are possible: more motions than were sent, or more answers than motions, would corrupt
  /// the counts of losses.
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
  std::vector<Sent> sent_;  // ring buffer of the last motions
  std::optional<wire::EnvironmentForce> newest_;
  Nanoseconds newest_arrival_{0};

  std::uint64_t session_ = 0;
  time::SequenceWindow arrivals_;
  wire::Bye server_;             // the server's counts so far, this session
  std::uint64_t sent_here_ = 0;  // this session
  std::uint64_t received_ = 0;   // this session
  std::uint64_t settled_ = 0;    // number of the newest motion answered, or of the last before this session
  Nanoseconds round_trip_{0};    // the longest, this session
  Nanoseconds lateness_{0};      // the largest of a motion that came after newer ones, this session
  std::uint64_t earlier_ = 0;    // number of the last motion of earlier sessions
  Counts ended_;                 // of ended sessions, and of datagrams of no session
};

}  // namespace forcebound::client
