// What a session writes down: each tick, each force, and the totals.

#include <algorithm>
#include <limits>
#include <string>

#include "forcebound/client/session/session.hpp"

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

}  // namespace

void Session::write_down(const Done& done) const noexcept {
  record::TickRecord record{
      .tick = ticks_,
      .time = done.reading.latched,
      .interval = done.interval,
      .latency = done.latency,
      .state = state(),
      .policy = policy_,
      .motion_sequence = done.motion_sequence,
      .force_sequence = done.force_sequence,
      .force_age = done.force_age,
      .position = done.reading.position,
      .joint = done.reading.joint,
      .request = done.request.force_N,
      .applied = done.applied.head(done.request.force_N.rows()),
      .energy_J = law().energy_J(),
      .xi = law().xi(),
      .rendering = recorded(done.request.local || done.request.models.model_N.rows() > 0, done.request.models.held),
      .remote = done.request.remote_N,
      .model = done.request.models.model_N,
      .model_deviation_m = done.request.models.deviation_m,
      .handle = done.reading.handle};
  if (device_.facts().rotations > 0) {
    record.request_torque_N_m = done.request.torque_N_m;
    record.applied_torque_N_m = done.applied.tail<3>();
  }
  if (done.request.local) {
    record.local = done.request.local->force_N;
    record.local_scene = done.request.local->scene;
    record.local_scene_age = now_ - local_since_;
  }
  note_contact(done, record);
  if (const auto audit = device_.audit()) {
    record.audit_J = audit->energy_J;
    record.audit_minimum_J = audit->minimum_J;
  }
  for (record::TickSink* sink : sinks_.ticks) sink->on_tick(record);
}

void Session::write_down(const wire::EnvironmentForce& force, Nanoseconds arrival) const noexcept {
  const record::ForceRecord record{
      .receive_time = arrival,
      .round_trip = std::max(Nanoseconds::zero(), arrival - ForceStream::reading_time(force)),
      .force = force};
  for (record::TickSink* sink : sinks_.ticks) sink->on_force(record);
}

void Session::note_contact(const Done& done, record::TickRecord& record) const noexcept {
  record.contact = false;
  record.penetration_m = kUnknown;
  record.displayed_N = 0;
  // Where nothing that runs here is touched, the contact may be with what the server alone computes.
  if (const auto& local = done.request.local; local && (local->penetration_m > 0 || !done.request.with_server_parts)) {
    record.contact = local->penetration_m > 0;
    record.penetration_m = local->penetration_m;
    if (record.contact) record.displayed_N = record.applied.dot(local->contact_normal);
    return;
  }
  const auto& force = forces_.newest();
  if (!force || policy_ == ForcePolicy::dropped) return;
  const Vector away = done.tip - force->position;
  const bool near = away.head(std::min(away.rows(), kTranslationsMax)).norm() <= kPlaneReach_m;
  record.contact = force->contact_normal.rows() == record.applied.rows();
  if (!record.contact) {
    if (near) record.penetration_m = 0;
    return;
  }
  record.displayed_N = record.applied.dot(force->contact_normal);
  if (!near) return;
  record.penetration_m = force->penetration_m - force->contact_normal.dot(away);
  record.contact = record.penetration_m > 0;
}

record::RunTotals Session::totals() const {
  const ForceStream::Counts network = forces_.counts(now_);
  record::RunTotals totals;
  totals.scene = scene_;
  totals.simulated = simulated_;
  totals.malformed = counts_.malformed;
  totals.foreign_session = counts_.foreign_session;
  totals.refusals = counts_.refusals;
  totals.send_failures = counts_.send_failures;
  totals.held_too_long = counts_.held_too_long;
  totals.released_by_device = counts_.released_by_device;
  totals.stale_readings = counts_.stale_readings;
  totals.readings = counts_.readings;
  const device::DeviceCounters device = device_.counters();
  totals.device_gaps_cut = device.gaps_cut;
  totals.device_frozen_joints = device.frozen_joints;
  totals.device_faulty_commands = device.faulty_commands;
  totals.device_handle_refused = device.handle_refused;
  if (!device_.last_error().empty()) {
    totals.notes.push_back(device_.facts().name + ": " + std::string(device_.last_error()));
  }
  totals.sent = network.sent;
  totals.received = network.received;
  totals.lost_up = network.lost_up;
  totals.lost_down = network.lost_down;
  totals.in_flight = network.in_flight;
  totals.unanswered = network.unanswered;
  totals.duplicated = network.duplicated + network.motions_duplicated;
  totals.reordered = network.reordered + network.motions_reordered;
  totals.foreign_session += network.foreign;
  totals.malformed[static_cast<std::size_t>(wire::Malformed::unreadable)] += network.implausible;
  totals.non_finite_requests = controller_.counts().requests_not_finite;
  totals.impossible_intervals = controller_.counts().intervals_impossible;
  totals.withdrawn_forces = controller_.counts().withdrawn;
  totals.readings_too_far = controller_.counts().readings_too_far;
  totals.failed_writes = controller_.counts().writes_failed;
  totals.effects_outside_facts = controller_.counts().effects_outside_facts;
  totals.releases_outside_facts = controller_.counts().releases_outside_facts;
  totals.longest_blackout = outages_.longest(last_tick_);
  if (totals.longest_blackout.duration > Nanoseconds::zero()) {
    const std::string& server = options_.server_in_words;
    totals.notes.push_back(
        record::words_of(totals.longest_blackout, server.empty() ? net::to_string(options_.server) : server));
  }
  totals.slew_bounded = rendering_.force_slew_bounded();
  totals.torque_slew_bounded = rendering_.torque_slew_bounded();
  totals.trips_of_speed = safety_.trips(HandSafety::Trip::speed);
  totals.trips_of_turn = safety_.trips(HandSafety::Trip::turn);
  totals.trips_of_workspace = safety_.trips(HandSafety::Trip::workspace);
  totals.trips_of_heat = safety_.trips(HandSafety::Trip::heat);
  totals.trips_of_dead_man = safety_.trips(HandSafety::Trip::dead_man);
  totals.trips_of_frozen_readings = safety_.trips(HandSafety::Trip::frozen);
  totals.models_refused = rendering_.answers().refused();
  if (clocks_.known()) {
    totals.server_ahead = clocks_.ahead();
    totals.server_ahead_off = clocks_.uncertainty(last_tick_);
  }
  if (options_.local != nullptr) {
    const HandoverCounts scenes = options_.local->builder().counts();
    totals.scene_pieces = options_.local->pieces_received();
    totals.scene_piece_bytes = options_.local->piece_bytes_received();
    totals.scenes_from_cache = scenes.from_cache;
    totals.scenes_refused = scenes.refused;
    totals.parts_quarantined = options_.local->parts_quarantined();
    totals.searches_exhausted = options_.local->searches_exhausted();
    if (!scenes.why_refused.empty()) totals.notes.push_back("scene refused: " + scenes.why_refused);
    if (!scenes.cache_problem.empty()) totals.notes.push_back(scenes.cache_problem);
  }
  totals.reconnects = connection_.sessions() > 0 ? connection_.sessions() - 1 : 0;
  return totals;
}

}  // namespace forcebound::client
