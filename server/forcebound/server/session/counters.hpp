#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "forcebound/server/environment/environment.hpp"
#include "forcebound/wire/codec.hpp"

namespace forcebound::server {

/// Everything that happened to a server, by reason. Nothing is dropped that is not counted here.
struct ServerCounters {
  std::uint64_t datagrams = 0;
  std::array<std::uint64_t, wire::kMalformedReasons> malformed{};  ///< by wire::Malformed
  std::uint64_t unexpected = 0;  ///< well formed, but of a kind that only a server sends

  std::uint64_t sessions_opened = 0;
  std::uint64_t sessions_ended = 0;     ///< by the client's Bye
  std::uint64_t sessions_idle = 0;      ///< closed because nothing came any more
  std::uint64_t hellos_repeated = 0;    ///< answered with the session they already had
  std::uint64_t hellos_after_bye = 0;   ///< copies on the way longer than their session lived
  std::uint64_t hellos_too_early = 0;   ///< for a scene that was still being compiled: to be said again
  std::uint64_t hellos_to_measure = 0;  ///< for a scene that depends on how far away the client is: to be said again
  std::uint64_t hellos_refused = 0;
  std::uint64_t hellos_over_rate = 0;
  std::uint64_t byes_repeated = 0;
  std::uint64_t byes_unknown = 0;
  std::uint64_t addresses_changed = 0;

  std::uint64_t motions_received = 0;
  std::uint64_t motions_duplicated = 0;
  std::uint64_t motions_reordered = 0;        ///< received after a newer one, and not answered
  std::uint64_t motions_superseded = 0;       ///< received, but a newer one waited when it would have been answered
  std::uint64_t motions_over_rate = 0;        ///< received, but not answered
  std::uint64_t motions_after_end = 0;        ///< received, but its session ended before its answer
  std::uint64_t motions_of_wrong_size = 0;    ///< not as many rows as the session's device has
  std::uint64_t motions_without_session = 0;  ///< refused
  std::uint64_t forces_sent = 0;
  std::uint64_t sends_failed = 0;

  std::uint64_t responses_unsound = 0;    ///< of an environment, not finite or of wrong size: zero force was sent
  std::uint64_t old_normals = 0;          ///< contacts whose direction had to be the last valid one
  std::uint64_t objects_quarantined = 0;  ///< objects of a session whose force was not finite: left out from then on

  std::uint64_t contacts_left_out = 0;  ///< in tissue or among bodies: more than there was room for
  std::uint64_t not_converged = 0;      ///< steps of tissue that their budget ended
  double slipped_s = 0;  ///< simulated time of bodies left out, because there was too much to make up for

  /// Received and not answered: what is missing between motions received and forces sent, if every force went out and
  /// no motion waits.
  [[nodiscard]] std::uint64_t motions_unanswered() const noexcept {
    return motions_reordered + motions_superseded + motions_over_rate + motions_after_end;
  }

  /// Those of one session.
  void add(const EnvironmentFaults& faults) noexcept;

  /// One line per subject; what never happened is left out.
  [[nodiscard]] std::string text() const;
};

}  // namespace forcebound::server
