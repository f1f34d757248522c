#pragma once

#include <cstdint>
#include <string>

#include "forcebound/server/offer/environment.hpp"
#include "forcebound/wire/malformed.hpp"

namespace forcebound::server {

/// Events of a server that are counted: COUNT(SUBJECT, NAME, WORDS), in the order in which they are told; of a subject
/// the first is told even where it is zero. A new counter is a new row, and a line that counts.
#define FORCEBOUND_SERVER_COUNTS(COUNT)                                                                               \
  COUNT("sessions", sessions_opened, "opened")                                                                        \
  COUNT("sessions", sessions_ended, "ended by the client")                                                            \
  COUNT("sessions", sessions_idle, "closed as idle")                                                                  \
  COUNT("sessions", sessions_still, "closed for another, as not moving")                                              \
  COUNT("sessions", sessions_removed, "ended by whoever runs the server")                                             \
  COUNT("sessions", hellos_refused, "hellos refused")                                                                 \
  COUNT("sessions", hellos_of_other_versions, "of them of another protocol version")                                  \
  COUNT("sessions", hellos_too_early,                                                                                 \
        "hellos before their scene or place was ready") /* its scene is still being compiled, its place freed, or     \
                                                           another worker makes a scene */                            \
  COUNT("sessions", hellos_to_measure, "hellos without a round trip")                                                 \
  COUNT("sessions", hellos_repeated, "hellos repeated")                                                               \
  COUNT("sessions", hellos_after_bye, "hellos after bye")                                                             \
  COUNT("sessions", hellos_over_rate, "hellos over the rate")                                                         \
  COUNT("sessions", hellos_out_of_memory, "hellos without memory for them")                                           \
  COUNT("sessions", byes_repeated, "byes repeated")                                                                   \
  COUNT("sessions", byes_unknown, "byes of unknown sessions")                                                         \
  COUNT("sessions", addresses_changed, "changes of address")                                                          \
  COUNT("motions", motions_received, "received")                                                                      \
  COUNT("motions", motions_duplicated, "duplicated")                                                                  \
  COUNT("motions", motions_reordered, "reordered") /* received after a newer one, and not answered */                 \
  COUNT("motions", motions_superseded,                                                                                \
        "superseded by newer ones")                    /* received, but replaced by a newer one before its answer */  \
  COUNT("motions", motions_over_rate, "over the rate") /* received, but not answered */                               \
  COUNT("motions", motions_over_budget,                                                                               \
        "beyond their session's share of the processor") /* received, but the session had used up its share of the    \
                                                            processor */                                              \
  COUNT("motions", motions_unproven,                                                                                  \
        "from addresses not yet proven") /* received, but not answered to a new address before that is proven */      \
  COUNT("motions", motions_after_end,                                                                                 \
        "after the end of their session") /* received, but its session ended before its answer */                     \
  COUNT("motions", motions_far_ahead,                                                                                 \
        "with numbers too far ahead") /* numbered as no client that keeps its rate can be; dropped */                 \
  COUNT("motions", motions_of_wrong_size, "of wrong size")       /* not as many rows as the session's device has */   \
  COUNT("motions", motions_without_session, "without a session") /* refused */                                        \
  COUNT("motions", datagrams_of_others,                                                                               \
        "or Byes for another client's session") /* motions and Byes for a session that another client opened */       \
  COUNT("forces", forces_sent, "sent")                                                                                \
  COUNT("forces", sends_failed, "datagrams not sent")                                                                 \
  COUNT("forces", responses_unsound,                                                                                  \
        "of zero because the environment's response was unsound") /* of an environment, not finite or of wrong size;  \
                                                                     zero force was sent */                           \
  COUNT("forces", models_unsound,                                                                                     \
        "with a local model that was unsound and left out") /* local models of an environment, not sent: their forces \
                                                               are held */                                            \
  COUNT("forces", objects_quarantined,                                                                                \
        "of objects not finite and left out") /* objects left out of a session from then on, because their force was  \
                                                 not finite */                                                        \
  COUNT("forces", old_normals,                                                                                        \
        "with the last valid normal") /* contacts with the last valid normal, for lack of one of their own */         \
  COUNT("forces", contacts_left_out,                                                                                  \
        "contacts beyond the room for them") /* contacts of tissue or bodies beyond the fixed maximum */              \
  COUNT("forces", not_converged, "steps of tissue not converged")                                                     \
  COUNT("forces", slipped_us, "us of bodies' time left out")      /* too much was due at once */                      \
  COUNT("pieces of scenes", pieces_sent, "sent")                  /* of scenes that clients render themselves */      \
  COUNT("pieces of scenes", pieces_sent_again, "sent again")      /* because they were not acknowledged in time */    \
  COUNT("pieces of scenes", view_pieces_sent, "of how they look") /* of how scenes look, to clients that show them */ \
  COUNT("datagrams", datagrams, "received")                                                                           \
  COUNT("datagrams", unexpected, "unexpected") /* of a kind that only a server sends; their content is not read */

/// Counts of a server's events, by reason. Whatever is dropped is counted here.
struct ServerCounters {
#define FORCEBOUND_MEMBER(subject, name, words) std::uint64_t name = 0;
  FORCEBOUND_SERVER_COUNTS(FORCEBOUND_MEMBER)
#undef FORCEBOUND_MEMBER
  wire::MalformedCounts malformed{};

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
