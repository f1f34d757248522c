#include "forcebound/client/session/session.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "forcebound/client/session/texture.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::client {
namespace {

// A burst of more than this waits for the next tick: the tick's work is bounded.
constexpr int kDatagramsPerTickMax = 64;
constexpr Nanoseconds kByePause = std::chrono::milliseconds{50};
constexpr int kAnswersWithoutNews = 5;

// Of a surface an answer tells the plane at one place. Along a surface bent with a radius of 20 mm it is 25 um off this
// far away; further away nothing is said of how deep the device is.
constexpr double kPlaneReach_m = 1e-3;
constexpr Eigen::Index kTranslationsMax = 3;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

Connection::Facts connection_facts(const control::DeviceFacts& device, const std::string& scene,
                                   std::string_view port) {
  return {.device = device.name,
          .scene = scene,
          .port = std::string(port),
          .degrees_of_freedom = device.degrees_of_freedom(),
          .period_s = device.period_s,
          .force_N_max = device.force_N_max};
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
      connection_(connection_facts(device.facts(), options_.scene, controller_.law().port()),
                  options_.seed + static_cast<std::uint64_t>(clock.now().count())),
      forces_(device.facts().degrees_of_freedom()),
      blackouts_(options_.policy.hold) {
  options_.policy.validate();
  totals_.scene.reserve(wire::kNameBytesMax);
  totals_.simulated.reserve(wire::kTextBytesMax);
}

void Session::tick(Nanoseconds now) noexcept {
  now_ = now;
  const device::Reading reading = device_.read(now);
  send_motion(controller_.law().proxy_position(reading.position), now);
  receive_all(now);
  keep_connected(now);

  choosing_since_ = clock_.now();
  const control::Motion motion = motion_at(reading, now);
  totals_.released_by_device += motion.held_s < motion.interval_s;
  totals_.held_too_long +=
      !device_.facts().releases && motion.interval_s - motion.latency_s > device_.facts().hold_s_max;
  const Vector request = request_at(reading.position, now);
  const bool silent = record_.policy == record::ForcePolicy::none || record_.policy == record::ForcePolicy::dropped;
  const Vector chosen = silent ? controller_.release(motion) : controller_.tick(motion, request);
  const Nanoseconds commanded = clock_.now();
  choosing_.note(commanded - choosing_since_);
  const Vector applied = controller_.confirmed(chosen, latency_s(commanded - now));
  device_.apply(commanded, applied);

  record_.interval = previous_reading_ ? now - *previous_reading_ : Nanoseconds::zero();
  record_.latency = commanded - now;
  previous_reading_ = now;
  previous_command_ = commanded;
  record_.request = request;
  write_down(reading, applied, now);
}

control::Motion Session::motion_at(const device::Reading& reading, Nanoseconds now) const noexcept {
  control::Motion motion{
      .position = reading.position, .joint = reading.joint, .jacobian = reading.jacobian, .damping = reading.damping};
  if (previous_reading_) {
    motion.interval_s = time::to_seconds(now - *previous_reading_);
    motion.latency_s = latency_s(*previous_command_ - *previous_reading_);
    if (const auto released = device_.released_at()) {
      motion.held_s = time::to_seconds(*released - *previous_reading_) - motion.latency_s;
    }
  }
  motion.latency_s_max = latency_s(choosing_since_ - now + choosing_.allowed());
  return motion;
}

double Session::latency_s(Nanoseconds reading_to_command) const noexcept {
  return time::to_seconds(reading_to_command) + device_.facts().latency_s;
}

Vector Session::request_at(const Vector& position, Nanoseconds now) noexcept {
  const auto& newest = forces_.newest();
  if (!newest) {
    record_.policy = record::ForcePolicy::none;
    record_.force_sequence = 0;
    record_.force_age = {};
    return Vector::Zero(device_.facts().degrees_of_freedom());
  }
  const Nanoseconds age = now - ForceStream::reading_time(*newest);
  note_policy(options_.policy.verdict(age), age, now);
  record_.force_sequence = newest->motion_sequence;
  record_.force_age = age;
  return options_.policy.scale(age) * (newest->force + texture_force_N(*newest, position));
}

void Session::note_policy(record::ForcePolicy policy, Nanoseconds age, Nanoseconds now) noexcept {
  using record::ForcePolicy;
  if (policy == record_.policy) return;
  const ForcePolicy before = std::exchange(record_.policy, policy);
  if (policy == ForcePolicy::fresh) {
    if (before != ForcePolicy::none) tell(Event::Kind::force_fresh, now, {}, now - not_fresh_since_);
    return;
  }
  if (before == ForcePolicy::fresh || before == ForcePolicy::none)
    not_fresh_since_ = now - (age - options_.policy.hold);
  tell(policy == ForcePolicy::fading ? Event::Kind::force_fading : Event::Kind::force_dropped, now, {}, age);
}

void Session::send_motion(const Vector& position, Nanoseconds now) noexcept {
  record_.motion_sequence = 0;
  if (connection_.session() == 0 || !position.allFinite()) return;
  record_.motion_sequence = forces_.note_sent(now);
  const wire::MotionSample motion{.session = connection_.session(),
                                  .sequence = record_.motion_sequence,
                                  .device_time = now,
                                  .position = position,
                                  .port = law().outgoing()};
  if (!send(motion)) forces_.note_not_sent();
}

bool Session::send(const wire::Message& message) noexcept {
  const bool sent = link_.send(codec_.encode(message), options_.server);
  if (!sent) ++totals_.send_failures;
  return sent;
}

void Session::receive_all(Nanoseconds now) noexcept {
  for (int i = 0; i < kDatagramsPerTickMax; ++i) {
    const auto received = link_.receive(buffer_);
    if (!received) return;
    const Nanoseconds read_at = clock_.now();
    if (received->from != options_.server) {
      ++totals_.foreign_session;
      continue;
    }
    const auto decoded = codec_.decode(std::span(buffer_).first(std::min(received->bytes, buffer_.size())));
    if (const auto* reason = std::get_if<wire::Malformed>(&decoded)) {
      ++totals_.malformed[static_cast<std::size_t>(*reason)];
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
      totals_.foreign_session += welcome->session != connection_.session();
      return;
    }
    forces_.begin_session(welcome->session);
    controller_.begin_server_side();
    silent_since_ = now;
    totals_.scene.assign(welcome->scene);
    totals_.simulated.assign(welcome->simulated);
    text::make_printable(totals_.scene);
    text::make_printable(totals_.simulated);
    tell(Event::Kind::welcomed, now, totals_.simulated);
  } else if (const auto* refusal = std::get_if<wire::Refusal>(&message)) {
    receive_refusal(*refusal, now, arrival);
  } else if (const auto* bye = std::get_if<wire::Bye>(&message)) {
    receive_bye(*bye, now);
  } else {
    ++totals_.malformed[static_cast<std::size_t>(wire::Malformed::unreadable)];
  }
}

void Session::receive_refusal(const wire::Refusal& refusal, Nanoseconds now, Nanoseconds arrival) noexcept {
  switch (connection_.on_refusal(refusal, arrival)) {
    case Connection::Refused::not_us:
      ++totals_.foreign_session;
      break;
    case Connection::Refused::session:
      tell(Event::Kind::session_unknown, now, refusal.text);
      break;
    case Connection::Refused::hello:
      refused_ = true;
      tell(Event::Kind::refused, now, refusal.text);
      break;
    case Connection::Refused::for_now:
      break;
  }
}

void Session::receive_force(const wire::EnvironmentForce& force, Nanoseconds now, Nanoseconds arrival) noexcept {
  switch (forces_.accept(force, arrival)) {
    case ForceStream::Verdict::newest:
      silent_since_ = now;
      blackouts_.on_force(now, forces_.progress());
      controller_.hear(force.port);
      [[fallthrough]];
    case ForceStream::Verdict::overtaken:
      note_news(now);
      force_record_.receive_time = arrival;
      force_record_.round_trip = std::max(Nanoseconds::zero(), arrival - ForceStream::reading_time(force));
      force_record_.force = force;
      for (record::TickSink* sink : sinks_.ticks) sink->on_force(force_record_);
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
    ++totals_.foreign_session;
    return;
  }
  // While closing no forces come any more, which is no blackout.
  if (closing_) {
    blackouts_.on_bye(record_.time, forces_.final_progress(), BlackoutWatch::Bye::answers_ours);
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

void Session::write_down(const device::Reading& reading, const Vector& applied, Nanoseconds now) noexcept {
  ++record_.tick;
  record_.time = now;
  record_.state = connection_.state();
  record_.position = reading.position;
  record_.joint = reading.joint;
  record_.applied = applied;
  record_.energy_J = law().energy_J();
  record_.xi = law().xi();
  note_contact(reading.position, applied);
  if (const auto audit = device_.audit()) {
    record_.audit_J = audit->energy_J;
    record_.audit_minimum_J = audit->minimum_J;
  }
  for (record::TickSink* sink : sinks_.ticks) sink->on_tick(record_);
}

void Session::note_contact(const Vector& position, const Vector& applied) noexcept {
  record_.contact = false;
  record_.penetration_m = kUnknown;
  record_.displayed_N = 0;
  const auto& force = forces_.newest();
  if (!force || record_.policy == record::ForcePolicy::dropped) return;
  const Vector away = position - force->position;
  const bool near = away.head(std::min(away.rows(), kTranslationsMax)).norm() <= kPlaneReach_m;
  record_.contact = force->contact_normal.rows() == applied.rows();
  if (!record_.contact) {
    if (near) record_.penetration_m = 0;
    return;
  }
  record_.displayed_N = applied.dot(force->contact_normal);
  if (!near) return;
  record_.penetration_m = force->penetration_m - force->contact_normal.dot(away);
  record_.contact = record_.penetration_m > 0;
}

bool Session::close(Nanoseconds now) noexcept {
  if (!std::exchange(closing_, true)) note_news(now);
  now_ = now;
  device_.apply(now, Vector::Zero(device_.facts().degrees_of_freedom()));
  receive_all(now);
  // A network that has held a datagram up for so long may hold up the last ones as long.
  const bool all_came = now - last_news_ >= forces_.longest_delay(time::from_seconds(device_.facts().period_s));
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
  record::RunTotals totals = totals_;
  totals.sent = network.sent;
  totals.received = network.received;
  totals.lost_up = network.lost_up;
  totals.lost_down = network.lost_down;
  totals.in_flight = network.in_flight;
  totals.overtaken = network.unanswered;
  totals.duplicated = network.duplicated + network.motions_duplicated;
  totals.reordered = network.overtaken + network.motions_overtaken;
  totals.foreign_session += network.foreign;
  totals.malformed[static_cast<std::size_t>(wire::Malformed::unreadable)] += network.implausible;
  totals.non_finite_requests = controller_.counts().requests_not_finite;
  totals.impossible_intervals = controller_.counts().intervals_impossible;
  totals.withdrawn_forces = controller_.counts().withdrawn;
  totals.non_finite_readings = controller_.counts().readings_not_finite;
  totals.longest_blackout = blackouts_.longest(record_.time);
  if (totals.longest_blackout.duration > Nanoseconds::zero()) {
    totals.notes.push_back(record::words_of(totals.longest_blackout, net::to_string(options_.server)));
  }
  totals.reconnects = connection_.sessions() > 0 ? connection_.sessions() - 1 : 0;
  return totals;
}

}  // namespace forcebound::client
