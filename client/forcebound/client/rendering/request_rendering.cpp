#include "forcebound/client/rendering/request_rendering.hpp"

#include <utility>

#include "forcebound/control/translation.hpp"

namespace forcebound::client {
namespace {

/// Ripples of the surface that the server's answer says is touched, at the device's present position.
Vector ripples_of(const wire::EnvironmentForce& newest, const Vector& pushing_N, const Vector& position) noexcept {
  return ripples_N(newest.answer, {.answered_at = newest.position, .position = position, .pushing_N = pushing_N});
}

}  // namespace

RequestRendering::Request RequestRendering::render(const std::optional<wire::EnvironmentForce>& newest,
                                                   const Tick& tick) noexcept {
  Request request{.force_N = Vector::Zero(tick.position.rows())};
  if (newest) {
    const Answer& answer = newest->answer;
    request.force_N = tick.share * (answer.force + ripples_of(*newest, answer.force, tick.position));
    request.torque_N_m = tick.share * control::translation_of(answer.torque_N_m);
  }
  request.remote_N = request.force_N;
  request.remote_N_m = request.torque_N_m;
  if (local_ != nullptr && tick.place.allFinite()) render_locally(newest, tick, request);
  request.force_N = force_limiter_.limit(request.force_N, tick.elapsed_s);
  last_request_N_m_ = request.torque_N_m;
  request.torque_N_m += tick.arm_m.cross(control::translation_of(request.force_N));
  request.torque_N_m = control::translation_of(torque_limiter_.limit(request.torque_N_m, tick.elapsed_s));
  last_request_N_ = request.force_N;
  return request;
}

/// In place of the server's answer for a past position: the answer of the scene at the client for the present one. The
/// force of the parts that only the server computes is added, as its local models go on from it, or held.
void RequestRendering::render_locally(const std::optional<wire::EnvironmentForce>& newest, const Tick& tick,
                                      Request& request) noexcept {
  request.local = local_->answer(tick.place, tick.read_at, newest, tick.handle);
  if (newest) {
    request.models = answers_.render(*newest, {.now = tick.read_at,
                                               .place = tick.place,
                                               .server_parts_alone = request.local.has_value(),
                                               .share = tick.share,
                                               .age = tick.age,
                                               .force_N_max = force_N_max_});
  }
  if (request.local) {
    // What stands still stays when the server is silent; what drives the device fades.
    if (tick.share < 1 && request.local->fading_N.rows() > 0)
      request.local->force -= (1 - tick.share) * request.local->fading_N;
    request.force_N = request.local->force;
    request.torque_N_m = control::translation_of(request.local->torque_N_m);
    request.local_scene = local_->scene().number();
    if (newest && tick.share > 0) add_server_parts(*newest, tick, request);
  }
  if (newest) request.force_N += request.models.correction_N;
  swap_sources(tick.now, request);
}

void RequestRendering::add_server_parts(const wire::EnvironmentForce& newest, const Tick& tick,
                                        Request& request) noexcept {
  const Vector& server_parts_N = newest.answer.server_parts_N;
  request.with_server_parts = server_parts_N.rows() == request.force_N.rows();
  if (!request.with_server_parts) return;
  request.force_N += tick.share * server_parts_N;
  if (newest.answer.texture_in_server_parts)
    request.force_N += tick.share * ripples_of(newest, server_parts_N, tick.position);
}

/// Where the scene at the client takes over, or ends, the force goes on from what it was.
void RequestRendering::swap_sources(Nanoseconds now, Request& request) noexcept {
  const bool local = request.local.has_value();
  const bool before = std::exchange(local_before_, local);
  const bool swapped = local != before || (local && local_->scene().swapped());
  if (swapped && last_request_N_.rows() == request.force_N.rows()) {
    // What the source until now would request now: the server's answer says it, a scene that does not answer any more
    // said it last.
    Vector until_now_N = last_request_N_;
    if (!before) {
      until_now_N = transfer_.applied_to(request.remote_N, now);
      if (request.models.correction_N.rows() == until_now_N.rows()) until_now_N += request.models.correction_N;
    }
    transfer_.begin(until_now_N, request.force_N, now);
    const Vector remote_N_m = request.remote_N_m;
    torque_transfer_.begin(before ? Vector(last_request_N_m_) : torque_transfer_.applied_to(remote_N_m, now),
                           request.torque_N_m, now);
  }
  request.force_N = transfer_.applied_to(request.force_N, now);
  request.torque_N_m = control::translation_of(torque_transfer_.applied_to(request.torque_N_m, now));
}

}  // namespace forcebound::client
