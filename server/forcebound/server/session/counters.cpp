#include "forcebound/server/session/counters.hpp"

#include "forcebound/server/session/count_line.hpp"

namespace forcebound::server {

void ServerCounters::add(const ServerCounters& other) noexcept {
  datagrams += other.datagrams;
  unexpected += other.unexpected;
  sessions_opened += other.sessions_opened;
  sessions_ended += other.sessions_ended;
  sessions_idle += other.sessions_idle;
  sessions_still += other.sessions_still;
  sessions_removed += other.sessions_removed;
  hellos_repeated += other.hellos_repeated;
  hellos_after_bye += other.hellos_after_bye;
  hellos_too_early += other.hellos_too_early;
  hellos_to_measure += other.hellos_to_measure;
  hellos_refused += other.hellos_refused;
  hellos_of_other_versions += other.hellos_of_other_versions;
  hellos_over_rate += other.hellos_over_rate;
  hellos_out_of_memory += other.hellos_out_of_memory;
  byes_repeated += other.byes_repeated;
  byes_unknown += other.byes_unknown;
  addresses_changed += other.addresses_changed;
  motions_received += other.motions_received;
  motions_duplicated += other.motions_duplicated;
  motions_reordered += other.motions_reordered;
  motions_superseded += other.motions_superseded;
  motions_over_rate += other.motions_over_rate;
  motions_over_budget += other.motions_over_budget;
  motions_unproven += other.motions_unproven;
  motions_after_end += other.motions_after_end;
  motions_far_ahead += other.motions_far_ahead;
  motions_of_wrong_size += other.motions_of_wrong_size;
  motions_without_session += other.motions_without_session;
  datagrams_of_others += other.datagrams_of_others;
  forces_sent += other.forces_sent;
  sends_failed += other.sends_failed;
  pieces_sent += other.pieces_sent;
  pieces_sent_again += other.pieces_sent_again;
  view_pieces_sent += other.view_pieces_sent;
  responses_unsound += other.responses_unsound;
  models_unsound += other.models_unsound;
  old_normals += other.old_normals;
  objects_quarantined += other.objects_quarantined;
  contacts_left_out += other.contacts_left_out;
  not_converged += other.not_converged;
  for (std::size_t i = 0; i < malformed.size(); ++i) malformed[i] += other.malformed[i];
  slipped_s += other.slipped_s;
}

void ServerCounters::add(const EnvironmentFaults& faults) noexcept {
  old_normals += faults.old_normals;
  objects_quarantined += faults.quarantined;
  contacts_left_out += faults.contacts_left_out;
  not_converged += faults.not_converged;
  slipped_s += faults.slipped_s;
}

std::string ServerCounters::text() const {
  return count_line("sessions", {"opened", sessions_opened},
                    {{"ended by the client", sessions_ended},
                     {"closed as idle", sessions_idle},
                     {"closed for another, as not moving", sessions_still},
                     {"ended by whoever runs the server", sessions_removed},
                     {"hellos refused", hellos_refused},
                     {"of them of another protocol version", hellos_of_other_versions},
                     {"hellos before their scene or place was ready", hellos_too_early},
                     {"hellos without a round trip", hellos_to_measure},
                     {"hellos repeated", hellos_repeated},
                     {"hellos after bye", hellos_after_bye},
                     {"hellos over the rate", hellos_over_rate},
                     {"hellos without memory for them", hellos_out_of_memory},
                     {"byes repeated", byes_repeated},
                     {"byes of unknown sessions", byes_unknown},
                     {"changes of address", addresses_changed}}) +
         count_line("motions", {"received", motions_received},
                    {{"duplicated", motions_duplicated},
                     {"reordered", motions_reordered},
                     {"superseded by newer ones", motions_superseded},
                     {"over the rate", motions_over_rate},
                     {"beyond their session's share of the processor", motions_over_budget},
                     {"from addresses not yet proven", motions_unproven},
                     {"after the end of their session", motions_after_end},
                     {"with numbers too far ahead", motions_far_ahead},
                     {"of wrong size", motions_of_wrong_size},
                     {"without a session", motions_without_session},
                     {"or Byes for another client's session", datagrams_of_others}}) +
         count_line("forces", {"sent", forces_sent},
                    {{"datagrams not sent", sends_failed},
                     {"of zero because the environment's response was unsound", responses_unsound},
                     {"with a local model that was unsound and left out", models_unsound},
                     {"of objects not finite and left out", objects_quarantined},
                     {"with the last valid normal", old_normals},
                     {"contacts beyond the room for them", contacts_left_out},
                     {"steps of tissue not converged", not_converged},
                     {"ms of bodies' time left out", static_cast<std::uint64_t>(slipped_s * 1e3)}}) +
         count_line("pieces of scenes", {"sent", pieces_sent},
                    {{"sent again", pieces_sent_again}, {"of how they look", view_pieces_sent}}) +
         count_line("datagrams", {"received", datagrams},
                    {{"oversize", malformed[static_cast<std::size_t>(wire::Malformed::oversize)]},
                     {"truncated", malformed[static_cast<std::size_t>(wire::Malformed::truncated)]},
                     {"foreign", malformed[static_cast<std::size_t>(wire::Malformed::foreign)]},
                     {"corrupt", malformed[static_cast<std::size_t>(wire::Malformed::corrupt)]},
                     {"unreadable", malformed[static_cast<std::size_t>(wire::Malformed::unreadable)]},
                     {"not finite", malformed[static_cast<std::size_t>(wire::Malformed::non_finite)]},
                     {"unexpected", unexpected}});
}

}  // namespace forcebound::server
