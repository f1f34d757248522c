#include "forcebound/client/session/renderer.hpp"

#include <algorithm>
#include <utility>

#include "forcebound/client/session/force_stream.hpp"
#include "forcebound/control/assertion.hpp"

namespace forcebound::client {

Renderer::Renderer(const Options& options, EventReporter& events)
    : local_(options.local),
      policy_(options.policy),
      events_(events),
      rendering_(options.local, options.force, options.torque) {
  policy_.validate();
}

void Renderer::begin_session(const wire::Welcome& welcome) noexcept {
  server_parts_ = welcome.server_parts;
  tool_.set_lever(welcome.tool_m);
  tool_lost_ = false;
  scene_offered_ = welcome.offer.manifest_bytes > 0;
  if (local_ != nullptr) local_->begin(welcome.session, welcome.offer);
}

void Renderer::receive(const wire::ScenePiece& piece) noexcept {
  if (local_ != nullptr) local_->receive(piece);
}

wire::PieceReceipt Renderer::begin_motion(Nanoseconds read_at) noexcept {
  if (local_ == nullptr) return {};
  local_->start_scene_time(read_at);
  return local_->receipt();
}

Renderer::Rendered Renderer::render(const Tick& tick) noexcept {
  RequestRendering::Tick at{.now = tick.now,
                            .read_at = tick.reading.latched,
                            .elapsed_s = tick.elapsed_s,
                            .position = tick.point.tip,
                            .place = tick.point.place,
                            .handle = tick.reading.handle,
                            .arm_m = tick.point.arm_m};
  Rendered rendered;
  if (tick.newest) {
    const Vector& force_N = tick.newest->answer.force;
    FORCEBOUND_ASSERT(force_N.rows() == tick.point.tip.rows() && force_N.allFinite(),
                      "a force that was accepted is finite, with a row for each degree of freedom");
    rendered.force_sequence = tick.newest->motion_sequence;
    rendered.force_age = tick.now - ForceStream::reading_time(*tick.newest);
    at.share = policy_.scale(rendered.force_age);
    at.age = model_age(*tick.newest, tick);
  }
  report_lost_tool(tick);
  const RequestRendering::Request& request = rendered.request;
  rendered.request = rendering_.render(tick.newest, at);
  if (local_ != nullptr && tick.point.place.allFinite()) report_scene(tick.now);
  rendered.policy = policy_of(request, tick, rendered.force_age);
  report_policy(rendered.policy, rendered.force_age, tick.now);
  rendered.need = need_of(request, tick);
  const bool no_answer = rendered.policy == ForcePolicy::none || rendered.policy == ForcePolicy::dropped;
  rendered.silent = no_answer && !request.local && request.models.model_N.rows() == 0;
  if (rendered.silent) rendering_.rest();
  return rendered;
}

/// By the device's clock the server's state is as old as the reading that it answers, or as one so long before as the
/// answer says: so far the server has played the device's path. Else it is as old as that motion's arrival there, which
/// was between the reading and the answer's arrival here. No model is asked about a time that is later than the reading
/// by more than the hold time.
ModelAge Renderer::model_age(const wire::EnvironmentForce& newest, const Tick& tick) const noexcept {
  const Nanoseconds at = tick.reading.latched;
  const Nanoseconds read = ForceStream::reading_time(newest);
  Nanoseconds told_of = newest.answer.model.state_time(read);
  Nanoseconds uncertain{0};
  if (!newest.answer.model.by_device_clock) {
    const Nanoseconds arrived = std::max(read, tick.newest_arrival);
    told_of = std::clamp(tick.clocks.by_device(newest.server_receive_time), read, arrived);
    uncertain = std::min(tick.clocks.uncertainty(at), arrived - read);
  }
  const Nanoseconds most = policy_.hold + std::max(Nanoseconds::zero(), read - told_of);
  const Nanoseconds age = std::clamp(at - told_of, Nanoseconds::zero(), most);
  return {.s = time::to_seconds(age), .uncertain_s = time::to_seconds(uncertain)};
}

/// Where all of the force is of what stands still at the client, no force is late, however old the server's answer.
ForcePolicy Renderer::policy_of(const RequestRendering::Request& request, const Tick& tick,
                                Nanoseconds age) const noexcept {
  if (!tick.newest) return ForcePolicy::none;
  const bool fades = request.local && request.local->fading_N.rows() > 0;
  const bool needs_none = local_ != nullptr && !fades && !request.models.fades;
  return needs_none ? ForcePolicy::fresh : policy_.verdict(age);
}

ServerNeed Renderer::need_of(const RequestRendering::Request& request, const Tick& tick) const noexcept {
  if (local_ == nullptr || !tick.newest) return {};
  return {.server_parts = request.models.held ? wire::ServerParts::held : server_parts_,
          .scene_runs = request.local.has_value() || !scene_offered_,
          .pieces_wanted = local_->receipt().wanted,
          .radius_m = rendering_.answers().least_radius_m(),
          .speed_m_per_s = rendering_.answers().speed_m_per_s(),
          .hold = policy_.hold,
          .round_trip = tick.newest_arrival - ForceStream::reading_time(*tick.newest)};
}

void Renderer::report_lost_tool(const Tick& tick) noexcept {
  if (tool_lost_ || !tool_.in_hand() || tick.reading.handle.orientation) return;
  tool_lost_ = true;
  events_.report(Event::Kind::tool_lost, tick.now);
}

void Renderer::report_scene(Nanoseconds now) noexcept {
  const BuildPhase phase = local_->phase();
  if (phase == std::exchange(scene_phase_, phase)) return;
  if (phase == BuildPhase::whole) events_.report(Event::Kind::scene_here, now);
  if (phase == BuildPhase::refused) events_.report(Event::Kind::scene_refused, now, local_->why_refused());
}

void Renderer::report_policy(ForcePolicy policy, Nanoseconds age, Nanoseconds now) noexcept {
  const ForcePolicy before = std::exchange(reported_, policy);
  if (policy == before || policy == ForcePolicy::none) return;
  if (policy == ForcePolicy::fresh) {
    if (before != ForcePolicy::none) events_.report(Event::Kind::force_fresh, now, {}, now - not_fresh_since_);
    return;
  }
  if (before == ForcePolicy::fresh || before == ForcePolicy::none) not_fresh_since_ = now - (age - policy_.hold);
  const bool fades = policy == ForcePolicy::fading;
  events_.report(fades ? Event::Kind::force_fading : Event::Kind::force_dropped, now, {}, age);
}

void Renderer::add_to(record::RunTotals& totals) const {
  totals.slew_bounded = rendering_.force_rate_limited();
  totals.torque_slew_bounded = rendering_.torque_rate_limited();
  totals.models_refused = rendering_.answers().refused();
  if (local_ == nullptr) return;
  const HandoverCounts scenes = local_->builder().counts();
  totals.scene_pieces = local_->pieces_received();
  totals.scene_piece_bytes = local_->piece_bytes_received();
  totals.scenes_from_cache = scenes.from_cache;
  totals.scenes_refused = scenes.refused;
  totals.parts_quarantined = local_->scene().quarantined();
  totals.searches_exhausted = local_->scene().searches_exhausted();
  if (!scenes.why_refused.empty()) totals.notes.push_back("scene refused: " + scenes.why_refused);
  if (!scenes.cache_problem.empty()) totals.notes.push_back(scenes.cache_problem);
}

}  // namespace forcebound::client
