// The server's answers to motions: the environment's force, and what goes with it.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "forcebound/control/assertion.hpp"
#include "forcebound/server/session/server.hpp"

namespace forcebound::server {
namespace {

bool is_sound(const Response& response, Eigen::Index rows) noexcept {
  const auto none_or_sound = [rows](const Vector& vector) {
    return vector.rows() == 0 || (vector.rows() == rows && vector.allFinite());
  };
  const bool torque_is_sound =
      response.torque_N_m.rows() == 0 ||
      (response.torque_N_m.rows() == Eigen::Vector3d::RowsAtCompileTime && response.torque_N_m.allFinite());
  return torque_is_sound && response.force.rows() == rows && response.force.allFinite() &&
         none_or_sound(response.contact_normal) && none_or_sound(response.server_parts_N) &&
         std::isfinite(response.penetration_m) && response.penetration_m >= 0 && std::isfinite(response.texture_N) &&
         response.texture_N >= 0 && none_or_sound(response.texture_wave) && none_or_sound(response.texture_across);
}

}  // namespace

Vector Server::ServerSide::place(const wire::MotionSample& motion) noexcept {
  if (!law) return motion.position;
  // A clock that runs backwards gives no interval.
  const Nanoseconds interval = motion.device_time - answered.value_or(motion.device_time);
  answered = motion.device_time;
  Vector at = law->place({.position = motion.position,
                          .numbers = motion.server_law_numbers,
                          .interval_s = time::to_seconds(std::max(interval, Nanoseconds::zero()))});
  // No environment, least of all a shared one, may receive a position that is not finite.
  const bool sound = at.rows() == motion.position.rows() && at.allFinite();
  return sound ? at : motion.position;
}

control::ServerSideLaw::Said Server::ServerSide::answer(const Vector& force_N) noexcept {
  if (!law) return {.force = force_N, .numbers = {}};
  return law->answer(force_N);
}

Response Server::ask(Session& session, const Motion& motion) noexcept {
  const Response response = session.made.environment->respond(motion);
  if (is_sound(response, motion.position.rows())) return response;
  ++counters_.responses_unsound;
  if (!std::exchange(session.unsound_noted, true)) observer_.on_unsound_response(session.info);
  return {.force = Vector::Zero(motion.position.rows()), .quarantined = response.quarantined};
}

/// The one place that checks it: here a stranger's environment enters, and scenes are like it.
local_model::LocalModel Server::model_of(const Session& session, const Response& response) noexcept {
  if (!session.wants_models || response.model.empty()) return {};
  if (local_model::is_sound(response.model)) return response.model;
  ++counters_.models_unsound;
  return {};
}

void Server::answer(Session& session, const Waiting& waiting) noexcept {
  const wire::MotionSample& motion = waiting.motion;
  const Nanoseconds now = waiting.since;
  observer_.on_motion(motion);
  const Nanoseconds begin = clock_.now();
  const Vector place = session.server_side.place(motion);
  FORCEBOUND_ASSERT(place.rows() == static_cast<Eigen::Index>(session.info.degrees_of_freedom) && place.allFinite(),
                    "an environment is asked about a place, with a row for each degree of freedom");
  const Response response = ask(session, {.position = place,
                                          .device_time = motion.device_time,
                                          .server_time = now,
                                          .wants_model = session.wants_models,
                                          .handle = control::sound(motion.handle).handle,
                                          .energy_given_J = motion.energy_given_J});
  const control::ServerSideLaw::Said said = session.server_side.answer(response.force);
  const Nanoseconds end = clock_.now();
  session.compute.note(end - begin, end);

  const wire::EnvironmentForce force{
      .session = motion.session,
      .sequence = session.arrivals.counts.forces_sent + 1,
      .motion_sequence = motion.sequence,
      .motion_device_time = motion.device_time,
      .force = said.force,
      .torque_N_m = response.torque_N_m,
      .position = place,
      .contact_normal = response.contact_normal,
      .penetration_m = response.penetration_m,
      .server_receive_time = now,
      .server_send_time = end,
      .compute_time = end - begin,
      .motions_received = session.arrivals.counts.motions_received,
      .motions_duplicated = session.arrivals.counts.motions_duplicated,
      .motions_reordered = session.arrivals.counts.motions_reordered,
      .texture_N = response.texture_N,
      .texture_wave = response.texture_wave,
      .texture_across = response.texture_across,
      .server_law_numbers = said.numbers,
      .server_parts_N = session.sender ? response.server_parts_N : Vector(),
      .texture_in_server_parts = response.texture_in_server_parts,
      .model = session.amplification.proven() ? model_of(session, response) : local_model::LocalModel{},
      .challenge = session.amplification.challenge(),
      .follower = response.follower};
  for (const std::string* name : response.quarantined) observer_.on_quarantined(session.info, *name);
  const std::span<const std::byte> encoded = codec_.encode(force);
  if (!session.amplification.proven() && !session.amplification.spend(encoded.size())) {
    ++counters_.motions_unproven;
    return;
  }
  if (!send_encoded(encoded, session.info.address)) return;
  ++session.arrivals.counts.forces_sent;
  ++counters_.forces_sent;
  observer_.on_force(force);
  if (session.sender && session.amplification.proven()) hand_over(session, motion, now);
  if (session.view && session.amplification.proven()) show(session, now);
}

void Server::hand_over(Session& session, const wire::MotionSample& motion, Nanoseconds now) noexcept {
  // Of a client that sends its motions rarely each brings in more; a burst of more would fill a queue on the way.
  constexpr int kPiecesPerMotionMax = 4;
  SceneSender& sender = *session.sender;
  sender.on_motion(motion, now);
  for (int i = 0; i < kPiecesPerMotionMax; ++i) {
    const auto next = sender.next(now);
    if (!next) return;
    ++(next->again ? counters_.pieces_sent_again : counters_.pieces_sent);
    send(wire::ScenePiece{.session = motion.session,
                          .transmission = next->transmission,
                          .number = next->number,
                          .content = sender.scene().piece(next->number)},
         session.info.address);
  }
}

/// One piece at most: a motion's answer never waits for a picture by more than the time of one.
void Server::show(Session& session, Nanoseconds now) noexcept {
  auto piece = session.view->next(*session.made.environment, views_, now);
  if (!piece) return;
  piece->session = session.info.session;
  ++counters_.view_pieces_sent;
  send(*piece, session.info.address);
}

}  // namespace forcebound::server
