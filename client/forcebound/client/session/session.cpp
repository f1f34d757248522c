#include "forcebound/client/session/session.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "forcebound/client/session/texture.hpp"
#include "forcebound/control/assertion.hpp"
#include "forcebound/text/printable.hpp"
#include "forcebound/wire/version_mismatch.hpp"

namespace forcebound::client {
namespace {

// A burst of more than this waits for the next tick: the tick's work is bounded.
constexpr int kDatagramsPerTickMax = 64;
constexpr Nanoseconds kByePause = std::chrono::milliseconds{50};
constexpr int kAnswersWithoutNews = 5;

// An answer describes a surface by its tangent plane at one place. For a radius of curvature of 20 mm the plane is 25
// um off at this distance; farther away no depth is given.
constexpr double kPlaneReach_m = 1e-3;
constexpr Eigen::Index kTranslationsMax = 3;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

Connection::Facts connection_facts(const control::DeviceFacts& device, const std::string& scene,
                                   std::string_view server_law) {
  return {.device = device.name,
          .scene = scene,
          .server_law = std::string(server_law),
          .degrees_of_freedom = device.degrees_of_freedom(),
          .period_s = device.period_s,
          .force_N_max = device.force_N_max};
}

record::SessionState recorded(SessionState state) noexcept {
  switch (state) {
    case SessionState::connecting:
      return record::SessionState::connecting;
    case SessionState::active:
      return record::SessionState::active;
    case SessionState::stale:
      return record::SessionState::stale;
    case SessionState::reconnecting:
      break;
  }
  return record::SessionState::reconnecting;
}

record::ForcePolicy recorded(ForcePolicy policy) noexcept {
  switch (policy) {
    case ForcePolicy::none:
      return record::ForcePolicy::none;
    case ForcePolicy::fresh:
      return record::ForcePolicy::fresh;
    case ForcePolicy::fading:
      return record::ForcePolicy::fading;
    case ForcePolicy::dropped:
      break;
  }
  return record::ForcePolicy::dropped;
}

}  // namespace

Session::Session(Options options, device::HapticDevice& device, std::unique_ptr<control::PassivityLaw> law,
                 net::DatagramLink& link, const time::Clock& clock, Sinks sinks)
    : options_(std::move(options)),
      device_(device),
      link_(link),
      clock_(clock),
      sinks_(sinks),
      controller_(device.facts(), std::move(law)),
      choosing_(time::from_seconds(device.facts().period_s)),
      // A client that was killed and starts again with the same seed is not the one before: its motions count from one.
      connection_(connection_facts(device.facts(), options_.scene, controller_.law().server_law()),
                  options_.seed + static_cast<std::uint64_t>(clock.now().count())),
      forces_(device.facts().degrees_of_freedom()),
      blackouts_(options_.policy.hold) {
  options_.policy.validate();
  scene_.reserve(wire::kNameBytesMax);
  simulated_.reserve(wire::kTextBytesMax);
}

void Session::tick(Nanoseconds now) noexcept {
  now_ = now;
  Done done{.reading = read_device(now)};
  const device::Reading& reading = done.reading;
  done.motion_sequence = send_motion(controller_.law().proxy_position(reading.position), reading.latched);
  receive_all(now);
  keep_connected(now);

  choosing_since_ = clock_.now();
  const control::Motion motion = motion_at(reading);
  counts_.released_by_device += motion.held_s < motion.interval_s;
  counts_.held_too_long +=
      !device_.facts().releases && motion.interval_s - motion.latency_s > device_.facts().hold_s_max;
  done.request = request_at(reading.position, now);
  const bool silent = policy_ == ForcePolicy::none || policy_ == ForcePolicy::dropped;
  const Vector chosen = silent ? controller_.release(motion) : controller_.tick(motion, done.request.force_N);
  const Nanoseconds commanded = clock_.now();
  choosing_.note(commanded - choosing_since_);
  done.latency = commanded - reading.latched;
  done.applied = controller_.confirmed(chosen, latency_s(done.latency));
  FORCEBOUND_ASSERT(done.applied.rows() == device_.facts().degrees_of_freedom() && done.applied.allFinite(),
                    "a force on its way to the device is finite, with a row for each degree of freedom");
  device_.apply(commanded, done.applied);

  done.interval = previous_reading_ ? reading.latched - *previous_reading_ : Nanoseconds::zero();
  previous_reading_ = reading.latched;
  previous_command_ = commanded;
  last_tick_ = reading.latched;
  ++ticks_;
  write_down(done);
}

/// After an unusable reading the device's state is unknown: the controller charges the worst case of the applied force,
/// and gives zero force.
device::Reading Session::read_device(Nanoseconds now) noexcept {
  device::Reading reading = device_.read(now);
  const int dof = device_.facts().degrees_of_freedom();
  if (device::is_usable(reading, dof) && reading.latched <= std::max(now, clock_.now())) {
    return reading;
  }
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  reading.position = reading.joint = Vector::Constant(dof, unknown);
  reading.jacobian = device::Matrix::Identity(dof, dof);
  reading.latched = now;
  return reading;
}

control::Motion Session::motion_at(const device::Reading& reading) const noexcept {
  control::Motion motion{
      .position = reading.position, .joint = reading.joint, .jacobian = reading.jacobian, .damping = reading.damping};
  if (previous_reading_) {
    motion.interval_s = time::to_seconds(reading.latched - *previous_reading_);
    motion.latency_s = latency_s(*previous_command_ - *previous_reading_);
    if (const auto effective = device_.effective_at()) {
      motion.effect_s = time::to_seconds(*effective - *previous_reading_);
    }
    motion.write_failed = device_.write_failed();
    if (const auto released = device_.released_at()) {
      motion.held_s = time::to_seconds(*released - *previous_reading_) - motion.latency_s;
    }
  }
  motion.latency_s_max = latency_s(choosing_since_ - reading.latched + choosing_.allowed());
  return motion;
}

double Session::latency_s(Nanoseconds reading_to_command) const noexcept {
  return time::to_seconds(reading_to_command) + device_.facts().latency_s;
}

Session::Request Session::request_at(const Vector& position, Nanoseconds now) noexcept {
  const auto& newest = forces_.newest();
  if (!newest) {
    policy_ = ForcePolicy::none;
    return {.force_N = Vector::Zero(device_.facts().degrees_of_freedom())};
  }
  FORCEBOUND_ASSERT(newest->force.rows() == device_.facts().degrees_of_freedom() && newest->force.allFinite(),
                    "a force that was accepted is finite, with a row for each degree of freedom");
  const Nanoseconds age = now - ForceStream::reading_time(*newest);
  note_policy(options_.policy.verdict(age), age, now);
  return {.force_N = options_.policy.scale(age) * (newest->force + texture_force_N(*newest, position)),
          .motion_sequence = newest->motion_sequence,
          .age = age};
}

void Session::note_policy(ForcePolicy policy, Nanoseconds age, Nanoseconds now) noexcept {
  if (policy == policy_) return;
  const ForcePolicy before = std::exchange(policy_, policy);
  if (policy == ForcePolicy::fresh) {
    if (before != ForcePolicy::none) tell(Event::Kind::force_fresh, now, {}, now - not_fresh_since_);
    return;
  }
  if (before == ForcePolicy::fresh || before == ForcePolicy::none)
    not_fresh_since_ = now - (age - options_.policy.hold);
  tell(policy == ForcePolicy::fading ? Event::Kind::force_fading : Event::Kind::force_dropped, now, {}, age);
}

std::uint64_t Session::send_motion(const Vector& position, Nanoseconds read_at) noexcept {
  if (connection_.session() == 0 || !position.allFinite()) return 0;
  const std::uint64_t sequence = forces_.note_sent(read_at);
  const wire::MotionSample motion{.session = connection_.session(),
                                  .sequence = sequence,
                                  .device_time = read_at,
                                  .position = position,
                                  .server_law_numbers = law().outgoing()};
  if (!send(motion)) forces_.note_not_sent();
  return sequence;
}

bool Session::send(const wire::Message& message) noexcept {
  const bool sent = link_.send(codec_.encode(message), options_.server);
  if (!sent) ++counts_.send_failures;
  return sent;
}

void Session::receive_all(Nanoseconds now) noexcept {
  for (int i = 0; i < kDatagramsPerTickMax; ++i) {
    const auto received = link_.receive(buffer_);
    if (!received) return;
    const Nanoseconds read_at = clock_.now();
    if (received->from != options_.server) {
      ++counts_.foreign_session;
      continue;
    }
    const auto decoded = codec_.decode(std::span(buffer_).first(std::min(received->bytes, buffer_.size())));
    if (const auto* reason = std::get_if<wire::Malformed>(&decoded)) {
      ++counts_.malformed[static_cast<std::size_t>(*reason)];
    } else {
      // Waited until now, which is later than the tick's time by the reading and the sending.
      receive(std::get<wire::Message>(decoded), now, read_at - received->waited);
    }
  }
}

void Session::receive(const wire::Message& message, Nanoseconds now, Nanoseconds arrival) noexcept {
  if (const auto* force = std::get_if<wire::EnvironmentForce>(&message)) {
    receive_force(*force, now, arrival);
  } else if (const auto* welcome = std::get_if<wire::Welcome>(&message)) {
    if (!connection_.on_welcome(*welcome)) {
      counts_.foreign_session += welcome->session != connection_.session();
      return;
    }
    forces_.begin_session(welcome->session);
    controller_.begin_server_side();
    silent_since_ = now;
    scene_.assign(welcome->scene);
    simulated_.assign(welcome->simulated);
    text::make_printable(scene_);
    text::make_printable(simulated_);
    tell(Event::Kind::welcomed, now, simulated_);
  } else if (const auto* refusal = std::get_if<wire::Refusal>(&message)) {
    receive_refusal(*refusal, now, arrival);
  } else if (const auto* bye = std::get_if<wire::Bye>(&message)) {
    receive_bye(*bye, now);
  } else {
    ++counts_.malformed[static_cast<std::size_t>(wire::Malformed::unreadable)];
  }
}

void Session::receive_refusal(const wire::Refusal& refusal, Nanoseconds now, Nanoseconds arrival) noexcept {
  switch (connection_.on_refusal(refusal, arrival)) {
    case Connection::Refused::not_us:
      ++counts_.foreign_session;
      break;
    case Connection::Refused::session:
      tell(Event::Kind::session_unknown, now, refusal.text);
      break;
    case Connection::Refused::hello:
      ++counts_.refusals;
      tell_refused(refusal, now);
      break;
    case Connection::Refused::for_now:
      break;
  }
}

void Session::tell_refused(const wire::Refusal& refusal, Nanoseconds now) noexcept {
  // Version 1 did not say which it is, nor what to do.
  const std::uint32_t version = std::max(refusal.protocol_version, 1U);
  if (refusal.reason != wire::RefusalReason::version_mismatch || version == wire::kProtocolVersion) {
    tell(Event::Kind::refused, now, refusal.text);
    return;
  }
  const wire::VersionMismatch mismatch(version, wire::kProtocolVersion);
  tell(Event::Kind::refused, now, mismatch.text());
}

void Session::receive_force(const wire::EnvironmentForce& force, Nanoseconds now, Nanoseconds arrival) noexcept {
  switch (forces_.accept(force, arrival)) {
    case ForceStream::Verdict::newest:
      silent_since_ = now;
      blackouts_.on_force(now, forces_.progress());
      controller_.hear(force.server_law_numbers);
      [[fallthrough]];
    case ForceStream::Verdict::reordered:
      note_news(now);
      write_down(force, arrival);
      break;
    case ForceStream::Verdict::duplicate:
    case ForceStream::Verdict::foreign:
    case ForceStream::Verdict::implausible:
      break;  // counted there
  }
}

void Session::receive_bye(const wire::Bye& bye, Nanoseconds now) noexcept {
  const Progress before = forces_.final_progress();
  // The first copy ended the session; a further one must not end the next.
  if (bye.session != connection_.session() || !forces_.accept(bye)) {
    ++counts_.foreign_session;
    return;
  }
  // While closing no forces come any more, which is no blackout.
  if (closing_) {
    blackouts_.on_bye(last_tick_, forces_.final_progress(), BlackoutWatch::Bye::answers_ours);
  } else {
    blackouts_.on_bye(now, forces_.final_progress(), BlackoutWatch::Bye::of_the_server);
  }
  if (!closing_) {
    connection_.on_bye();
    tell(Event::Kind::server_left, now, {});
  } else if (forces_.final_progress() == before) {
    ++answers_without_news_;
  } else {
    note_news(now);
  }
}

void Session::note_news(Nanoseconds now) noexcept {
  answers_without_news_ = 0;
  last_news_ = now;
}

void Session::keep_connected(Nanoseconds now) noexcept {
  connection_.on_blackout(now - silent_since_, options_.policy.hold, options_.policy.drop);
  if (connection_.hello_due(now)) (void)send(connection_.hello(clock_.now()));
}

void Session::write_down(const Done& done) const noexcept {
  record::TickRecord record{.tick = ticks_,
                            .time = done.reading.latched,
                            .interval = done.interval,
                            .latency = done.latency,
                            .state = recorded(state()),
                            .policy = recorded(policy_),
                            .motion_sequence = done.motion_sequence,
                            .force_sequence = done.request.motion_sequence,
                            .force_age = done.request.age,
                            .position = done.reading.position,
                            .joint = done.reading.joint,
                            .request = done.request.force_N,
                            .applied = done.applied,
                            .energy_J = law().energy_J(),
                            .xi = law().xi()};
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
  const auto& force = forces_.newest();
  if (!force || policy_ == ForcePolicy::dropped) return;
  const Vector away = done.reading.position - force->position;
  const bool near = away.head(std::min(away.rows(), kTranslationsMax)).norm() <= kPlaneReach_m;
  record.contact = force->contact_normal.rows() == done.applied.rows();
  if (!record.contact) {
    if (near) record.penetration_m = 0;
    return;
  }
  record.displayed_N = done.applied.dot(force->contact_normal);
  if (!near) return;
  record.penetration_m = force->penetration_m - force->contact_normal.dot(away);
  record.contact = record.penetration_m > 0;
}

bool Session::close(Nanoseconds now) noexcept {
  if (!std::exchange(closing_, true)) note_news(now);
  now_ = now;
  device_.stop(now);
  receive_all(now);
  // A network that has held a datagram up for so long may hold up the last ones as long.
  const bool all_came = now - last_news_ >= forces_.longest_delay();
  if (connection_.session() == 0 || (all_came && answers_without_news_ >= kAnswersWithoutNews)) return true;
  if (now >= next_bye_) {
    next_bye_ = now + kByePause;
    (void)send(wire::Bye{.session = connection_.session()});
  }
  return false;
}

void Session::tell(Event::Kind kind, Nanoseconds now, std::string_view words, Nanoseconds duration) noexcept {
  if (sinks_.events == nullptr) return;
  event_.kind = kind;
  event_.time = now;
  event_.duration = duration;
  event_.set_text(words);
  sinks_.events->on_event(event_);
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
  const device::DeviceCounters device = device_.counters();
  totals.device_gaps_cut = device.gaps_cut;
  totals.device_frozen_joints = device.frozen_joints;
  totals.device_faulty_commands = device.faulty_commands;
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
  totals.non_finite_readings = controller_.counts().readings_not_finite;
  totals.readings_too_far = controller_.counts().readings_too_far;
  totals.failed_writes = controller_.counts().writes_failed;
  totals.effects_outside_facts = controller_.counts().effects_outside_facts;
  totals.releases_outside_facts = controller_.counts().releases_outside_facts;
  totals.longest_blackout = blackouts_.longest(last_tick_);
  if (totals.longest_blackout.duration > Nanoseconds::zero()) {
    totals.notes.push_back(record::words_of(totals.longest_blackout, net::to_string(options_.server)));
  }
  totals.reconnects = connection_.sessions() > 0 ? connection_.sessions() - 1 : 0;
  return totals;
}

}  // namespace forcebound::client
