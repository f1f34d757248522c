#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "forcebound/server/environment/environment.hpp"
#include "forcebound/wire/codec.hpp"

namespace forcebound::server {

/// Counts of a server's events, by reason. Whatever is dropped is counted here.
struct ServerCounters {
  std::uint64_t datagrams = 0;
  std::array<std::uint64_t, wire::kMalformedReasons> malformed{};  ///< by wire::Malformed
  std::uint64_t unexpected = 0;  ///< of a kind that only a server sends; their content is not read

  std::uint64_t sessions_opened = 0;
  std::uint64_t sessions_ended = 0;    ///< by the client's Bye
  std::uint64_t sessions_idle = 0;     ///< closed after the idle timeout
  std::uint64_t sessions_still = 0;    ///< closed since another wanted the place of a device that did not move
  std::uint64_t sessions_removed = 0;  ///< ended on the page, or as their client was dropped from the list
  std::uint64_t hellos_repeated = 0;   ///< answered with the session that the client already has
  std::uint64_t hellos_after_bye = 0;  ///< copies that arrived after their session's end
  std::uint64_t hellos_too_early =
      0;  ///< its scene is still being compiled, its place freed, or another worker makes a scene
  std::uint64_t hellos_to_measure = 0;  ///< without the round trip that the scene needs: the client repeats it
  std::uint64_t hellos_refused = 0;
  std::uint64_t hellos_of_other_versions = 0;  ///< of the refused: by clients that speak another protocol version
  std::uint64_t hellos_over_rate = 0;
  std::uint64_t hellos_out_of_memory = 0;  ///< of the refused: there was no memory even to look at them
  std::uint64_t byes_repeated = 0;
  std::uint64_t byes_unknown = 0;
  std::uint64_t addresses_changed = 0;

  std::uint64_t motions_received = 0;
  std::uint64_t motions_duplicated = 0;
  std::uint64_t motions_reordered = 0;        ///< received after a newer one, and not answered
  std::uint64_t motions_superseded = 0;       ///< received, but replaced by a newer one before its answer
  std::uint64_t motions_over_rate = 0;        ///< received, but not answered
  std::uint64_t motions_over_budget = 0;      ///< received, but the session had used up its share of the processor
  std::uint64_t motions_unproven = 0;         ///< received, but not answered to a new address before that is proven
  std::uint64_t motions_after_end = 0;        ///< received, but its session ended before its answer
  std::uint64_t motions_far_ahead = 0;        ///< numbered as no client that keeps its rate can be; dropped
  std::uint64_t motions_of_wrong_size = 0;    ///< not as many rows as the session's device has
  std::uint64_t motions_without_session = 0;  ///< refused
  std::uint64_t datagrams_of_others = 0;      ///< motions and Byes for a session that another client opened
  std::uint64_t forces_sent = 0;
  std::uint64_t sends_failed = 0;
  std::uint64_t pieces_sent = 0;        ///< of scenes that clients render themselves
  std::uint64_t pieces_sent_again = 0;  ///< because they were not acknowledged in time
  std::uint64_t view_pieces_sent = 0;   ///< of how scenes look, to clients that show them

  std::uint64_t responses_unsound = 0;  ///< of an environment, not finite or of wrong size; zero force was sent
  std::uint64_t models_unsound = 0;     ///< local models of an environment, not sent: their forces are held
  std::uint64_t old_normals = 0;        ///< contacts with the last valid normal, for lack of one of their own
  std::uint64_t objects_quarantined =
      0;  ///< objects left out of a session from then on, because their force was not finite

  std::uint64_t contacts_left_out = 0;  ///< contacts of tissue or bodies beyond the fixed maximum
  std::uint64_t not_converged = 0;      ///< tissue steps that ended at the iteration limit
  double slipped_s = 0;                 ///< simulated time of bodies skipped, because too much was due at once

  /// Motions received and not answered: motions_received - forces_sent, if every send succeeded and no motion waits.
  [[nodiscard]] std::uint64_t motions_unanswered() const noexcept {
    return motions_reordered + motions_superseded + motions_over_rate + motions_after_end + motions_unproven +
           motions_over_budget;
  }

  /// Adds those of another server.
  void add(const ServerCounters& other) noexcept;

  /// Adds the faults of one session.
  void add(const EnvironmentFaults& faults) noexcept;

  /// One line per subject, without counts that are zero.
  [[nodiscard]] std::string text() const;
};

}  // namespace forcebound::server
