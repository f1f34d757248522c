#include "forcebound/client/session/session_recorder.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "forcebound/client/session/force_stream.hpp"
#include "forcebound/text/printable.hpp"
#include "forcebound/wire/codec.hpp"

namespace forcebound::client {
namespace {

// An answer describes a surface by its tangent plane at one place. For a radius of curvature of 20 mm the plane is 25
// um off at this distance; farther away no depth is given.
constexpr double kPlaneReach_m = 1e-3;
constexpr Eigen::Index kTranslationsMax = 3;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

record::ForceOrigin recorded(bool at_client, bool held) noexcept {
  if (!at_client) return record::ForceOrigin::held;
  return held ? record::ForceOrigin::both : record::ForceOrigin::at_client;
}

void record_contact(const SessionRecorder::Tick& tick, record::TickRecord& row) noexcept {
  const RequestRendering::Request& request = tick.rendered.request;
  row.contact = false;
  row.penetration_m = kUnknown;
  row.displayed_N = 0;
  // Where nothing that runs here is touched, the contact may be with what the server alone computes.
  if (const auto& local = request.local; local && (local->penetration_m > 0 || !request.with_server_parts)) {
    row.contact = local->penetration_m > 0;
    row.penetration_m = local->penetration_m;
    if (row.contact) row.displayed_N = row.applied.dot(local->contact_normal);
    return;
  }
  if (!tick.newest || tick.rendered.policy == ForcePolicy::dropped) return;
  const wire::Answer& answer = tick.newest->answer;
  const Vector away = tick.point.tip - tick.newest->position;
  const bool near = away.head(std::min(away.rows(), kTranslationsMax)).norm() <= kPlaneReach_m;
  row.contact = answer.contact_normal.rows() == row.applied.rows();
  if (!row.contact) {
    if (near) row.penetration_m = 0;
    return;
  }
  row.displayed_N = row.applied.dot(answer.contact_normal);
  if (!near) return;
  row.penetration_m = answer.penetration_m - answer.contact_normal.dot(away);
  row.contact = row.penetration_m > 0;
}

}  // namespace

SessionRecorder::SessionRecorder(std::span<record::TickSink* const> sinks) : sinks_(sinks) {
  scene_.reserve(wire::kNameBytesMax);
  simulated_.reserve(wire::kTextBytesMax);
}

std::string_view SessionRecorder::begin_session(const wire::Welcome& welcome) noexcept {
  scene_.assign(welcome.scene);
  simulated_.assign(welcome.simulated);
  text::make_printable(scene_);
  text::make_printable(simulated_);
  return simulated_;
}

void SessionRecorder::record(const wire::EnvironmentForce& force, Nanoseconds arrival) const noexcept {
  const record::ForceRecord row{.receive_time = arrival,
                                .round_trip = std::max(Nanoseconds::zero(), arrival - ForceStream::reading_time(force)),
                                .force = force};
  for (record::TickSink* sink : sinks_) sink->on_force(row);
}

void SessionRecorder::record(const Tick& tick) noexcept {
  const RequestRendering::Request& request = tick.rendered.request;
  const Actuation::Command& command = tick.command;
  record::TickRecord row{.tick = ++ticks_,
                         .time = tick.reading.latched,
                         .interval = command.interval,
                         .latency = command.latency,
                         .state = tick.state,
                         .policy = tick.rendered.policy,
                         .motion_sequence = tick.motion_sequence,
                         .force_sequence = tick.rendered.force_sequence,
                         .force_age = tick.rendered.force_age,
                         .position = tick.reading.position,
                         .joint = tick.reading.joint,
                         .request = command.request_N,
                         .applied = command.applied_N,
                         .request_torque_N_m = command.request_torque_N_m,
                         .applied_torque_N_m = command.applied_torque_N_m,
                         .energy_J = command.energy_J,
                         .xi = command.xi,
                         .rendering = recorded(request.local || request.models.model_N.rows() > 0, request.models.held),
                         .remote = request.remote_N,
                         .model = request.models.model_N,
                         .model_deviation_m = request.models.deviation_m,
                         .model_trust = request.models.trust,
                         .handle = tick.reading.handle};
  if (request.local) {
    if (request.local_scene != std::exchange(local_scene_, request.local_scene)) local_since_ = tick.now;
    row.local = request.local->force;
    row.local_scene = request.local_scene;
    row.local_scene_age = tick.now - local_since_;
  }
  record_contact(tick, row);
  if (command.audit) {
    row.audit_J = command.audit->energy_J;
    row.audit_minimum_J = command.audit->minimum_J;
  }
  for (record::TickSink* sink : sinks_) sink->on_tick(row);
}

void SessionRecorder::add_to(record::RunTotals& totals) const {
  totals.scene = scene_;
  totals.simulated = simulated_;
}

}  // namespace forcebound::client
