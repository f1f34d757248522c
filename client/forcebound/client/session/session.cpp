#include "forcebound/client/session/session.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "forcebound/control/assertion.hpp"
#include "forcebound/control/translation.hpp"
#include "forcebound/control/wrench.hpp"

namespace forcebound::client {
namespace {

constexpr Nanoseconds kByePause = std::chrono::milliseconds{50};
constexpr int kAnswersWithoutNews = 5;

Connection::Facts connection_facts(const control::DeviceFacts& device, const Session::Options& options,
                                   std::string_view server_law, bool shows_scene) {
  return {.device = device.name,
          .scene = options.scene,
          .server_law = std::string(server_law),
          .degrees_of_freedom = device.translations(),
          .period_s = device.period_s,
          .force_N_max = device.force_N_max,
          .renders_locally = options.local != nullptr,
          .shows_scene = shows_scene,
          .shows_torque = device.rotations > 0};
}

std::string_view words_of(HandSafety::Trip trip) noexcept {
  switch (trip) {
    case HandSafety::Trip::speed:
      return "the hand is faster than the device's limit: no force until it is half as fast, then a ramp";
    case HandSafety::Trip::turn:
      return "the hand turns faster than the device's limit: no force until it turns half as fast, then a ramp";
    case HandSafety::Trip::workspace:
      return "the hand has left the device's workspace: the force fades there";
    case HandSafety::Trip::heat:
      return "the motors' load is above the device's limit: the force is bounded until it is 10 % below";
    case HandSafety::Trip::dead_man:
      return "the dead-man button is not pressed: no force until it is, then a ramp";
    case HandSafety::Trip::frozen:
      return "the device's readings do not change, though the force on it has: frozen, or it is held fast; no force "
             "until they do, then a ramp";
  }
  return {};
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
      times_(device),
      schedule_(options_.send_rate, time::from_seconds(device.facts().period_s)),
      // A client that was killed and starts again with the same seed is not the one before: its motions count from one.
      connection_(connection_facts(device.facts(), options_, controller_.law().server_law(), sinks.view != nullptr),
                  options_.seed + static_cast<std::uint64_t>(clock.now().count())),
      forces_(device.facts().translations()),
      outages_(options_.policy.hold),
      rendering_(options_.local, {.slew_per_s = options_.force_slew_N_per_s, .most = device.facts().force_N_max},
                 {.slew_per_s = options_.torque_slew_N_m_per_s, .most = device.facts().torque_N_m_max}),
      safety_(device.safety(), device.facts().force_N_max, device.facts().torque_N_m_max),
      unseen_(device.facts(), safety_.limits()),
      last_applied_(Vector::Zero(device.facts().degrees_of_freedom())) {
  options_.policy.validate();
  const std::string_view server_law = controller_.law().server_law();
  const Nanoseconds interval = options_.send_rate.interval(time::from_seconds(device.facts().period_s));
  if (interval > Nanoseconds::zero() && !server_law.empty()) {
    throw std::invalid_argument("law '" + std::string(server_law) +
                                "' exchanges numbers with its server-side law on each tick: no other rate of motions "
                                "is accepted");
  }
  scene_.reserve(wire::kNameBytesMax);
  simulated_.reserve(wire::kTextBytesMax);
}

void Session::tick(Nanoseconds now) noexcept {
  now_ = now;
  Done done{.reading = read_device(now)};
  const device::Reading& reading = done.reading;
  const bool readable = reading.position.allFinite();
  tell_of_device(reading.status, now);
  if (times_.is_held_on(reading, now)) {
    ++counts_.stale_readings;
    receive_all(now);
    keep_connected(now);
    return;
  }
  ++counts_.readings[reading.status];
  tell_of_torque(reading, now);
  done.arm_m = tool_.arm_m(reading.handle.orientation);
  done.tip = tip_of(reading.position, done.arm_m);
  done.place = tip_of(controller_.law().proxy_position(reading.position), done.arm_m);
  // However rare motions are: a short press must not fall between two of them.
  if (readable && reading.handle.buttons != buttons_sent_) schedule_.send_at_once();
  if (readable && schedule_.is_due(reading.latched)) done.motion_sequence = send_motion(done.place, reading);
  receive_all(now);
  keep_connected(now);

  times_.begin_choosing(clock_.now());
  const control::Motion motion = times_.motion_at(reading);
  counts_.released_by_device += motion.held_s < motion.interval_s;
  counts_.held_too_long +=
      !device_.facts().releases && motion.interval_s - motion.latency_s > device_.facts().hold_s_max;
  done.request = request_at(done, now);
  const bool no_answer = policy_ == ForcePolicy::none || policy_ == ForcePolicy::dropped;
  const bool silent = no_answer && !done.request.local && done.request.models.model_N.rows() == 0;
  if (silent) rendering_.rest();
  const Vector chosen = silent ? controller_.release(motion) : controller_.tick(motion, wrench_of(done));
  const Nanoseconds commanded = clock_.now();
  done.latency = commanded - reading.latched;
  done.interval = times_.previous_reading() ? reading.latched - *times_.previous_reading() : Nanoseconds::zero();
  done.applied = controller_.confirmed(chosen, times_.command_at(reading, commanded));
  FORCEBOUND_ASSERT(done.applied.rows() == device_.facts().degrees_of_freedom() && done.applied.allFinite(),
                    "a force on its way to the device is finite, with a row for each degree of freedom");
  device_.apply(commanded, done.applied);
  last_applied_ = done.applied;

  last_tick_ = reading.latched;
  ++ticks_;
  write_down(done);
}

/// After an unusable reading the device's state is unknown: the controller charges the worst case of the applied force,
/// and gives zero force.
device::Reading Session::read_device(Nanoseconds now) noexcept {
  const device::Reading reading = device_.read(now);
  return device::usable_or_lost(reading, device_.facts(), now, std::max(now, clock_.now()));
}

void Session::tell_of_device(device::Reading::Status status, Nanoseconds now) noexcept {
  const DeviceWatch::Change change = device_watch_.note(status == device::Reading::Status::ok, now);
  const bool by_device = status == device::Reading::Status::failed;
  const std::string_view own = by_device ? device_.last_error() : std::string_view{};
  if (change == DeviceWatch::Change::gone)
    tell(Event::Kind::device_gone, now, own.empty() ? control::why(status) : own);
  if (change == DeviceWatch::Change::back) tell(Event::Kind::device_back, now, {}, device_watch_.pause());
}

/// The handle turns by the hand alone.
void Session::tell_of_torque(const device::Reading& reading, Nanoseconds now) noexcept {
  if (told_of_torque_ || device_.facts().rotations > 0 || !reading.handle.orientation) return;
  told_of_torque_ = true;
  tell(Event::Kind::no_torque, now, device_.facts().name);
}

Vector Session::wrench_of(const Done& done) const noexcept {
  return control::wrench_of(done.request.force_N, done.request.torque_N_m, device_.facts().rotations);
}

RequestRendering::Request Session::request_at(Done& done, Nanoseconds now) noexcept {
  const device::Reading& reading = done.reading;
  const auto& newest = forces_.newest();
  RequestRendering::Tick tick{
      .now = now,
      .read_at = reading.latched,
      .elapsed_s = times_.previous_reading() ? time::to_seconds(reading.latched - *times_.previous_reading()) : 0,
      .position = done.tip,
      .place = done.place,
      .handle = reading.handle,
      .arm_m = done.arm_m};
  if (newest) {
    FORCEBOUND_ASSERT(newest->force.rows() == device_.facts().translations() && newest->force.allFinite(),
                      "a force that was accepted is finite, with a row for each degree of freedom");
    done.force_sequence = newest->motion_sequence;
    done.force_age = now - ForceStream::reading_time(*newest);
    tick.share = options_.policy.scale(done.force_age);
    tick.age = model_age(*newest, reading.latched);
  }
  RequestRendering::Request request = rendering_.render(newest, tick);
  if (request.local && request.local->scene != std::exchange(local_scene_, request.local->scene)) local_since_ = now;
  if (options_.local != nullptr && done.place.allFinite()) tell_of_scene(now);
  note_late_force(request, done.force_age, now);
  schedule_.note(need_of(request));
  const int rotations = device_.facts().rotations;
  const Vector applied_N = last_applied_.head(device_.facts().translations());
  if (reading.position.allFinite()) unseen_.note(reading, last_applied_, tick.elapsed_s);
  HandSafety::Tick safety{.position = reading.position,
                          .applied_N = applied_N,
                          .elapsed_s = tick.elapsed_s,
                          .handle = reading.handle,
                          .believed = unseen_.share(),
                          .frozen = unseen_.frozen()};
  if (rotations > 0) safety.applied_N_m = last_applied_.tail<3>();
  request.force_N = safety_.limited(request.force_N, safety);
  request.torque_N_m = rotations > 0 ? safety_.limited_torque(request.torque_N_m) : Eigen::Vector3d::Zero();
  if (const auto trip = safety_.take_trip()) tell(Event::Kind::limited_for_safety, now, words_of(*trip));
  return request;
}

/// By the device's clock the server's state is as old as the reading that it answers, or as one so long before as the
/// answer says: so far the server has played the device's path. Else it is as old as that motion's arrival there, which
/// was between the reading and the answer's arrival here. No model is asked about a time that is later than the reading
/// by more than the hold time.
ModelAge Session::model_age(const wire::EnvironmentForce& newest, Nanoseconds at) const noexcept {
  const Nanoseconds read = ForceStream::reading_time(newest);
  Nanoseconds told_of = newest.model.state_time(read);
  Nanoseconds uncertain{0};
  if (!newest.model.by_device_clock) {
    const Nanoseconds arrived = std::max(read, newest_arrived_);
    told_of = std::clamp(clocks_.by_device(newest.server_receive_time), read, arrived);
    uncertain = std::min(clocks_.uncertainty(at), arrived - read);
  }
  const Nanoseconds most = options_.policy.hold + std::max(Nanoseconds::zero(), read - told_of);
  const Nanoseconds age = std::clamp(at - told_of, Nanoseconds::zero(), most);
  return {.s = time::to_seconds(age), .uncertain_s = time::to_seconds(uncertain)};
}

void Session::tell_of_scene(Nanoseconds now) noexcept {
  const BuildPhase phase = options_.local->phase();
  if (phase == std::exchange(scene_phase_, phase)) return;
  if (phase == BuildPhase::whole) tell(Event::Kind::scene_here, now, {});
  if (phase == BuildPhase::refused) tell(Event::Kind::scene_refused, now, options_.local->why_refused());
}

ServerNeed Session::need_of(const RequestRendering::Request& request) const noexcept {
  if (options_.local == nullptr || !forces_.newest()) return {};
  return {.server_parts = request.models.held ? wire::ServerParts::held : server_parts_,
          .scene_runs = request.local.has_value() || !scene_offered_,
          .pieces_wanted = options_.local->receipt().wanted,
          .radius_m = rendering_.answers().least_radius_m(),
          .speed_m_per_s = rendering_.answers().speed_m_per_s(),
          .hold = options_.policy.hold,
          .round_trip = newest_arrived_ - ForceStream::reading_time(*forces_.newest())};
}

/// Where all of the force is of what stands still at the client, no force is late, however old the server's answer.
void Session::note_late_force(const RequestRendering::Request& request, Nanoseconds age, Nanoseconds now) noexcept {
  if (!forces_.newest()) {
    policy_ = ForcePolicy::none;
    return;
  }
  const bool drives = request.local && request.local->driving_N.rows() > 0;
  const bool needs_none = options_.local != nullptr && !drives && !request.models.fades;
  note_policy(needs_none ? ForcePolicy::fresh : options_.policy.verdict(age), age, now);
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

std::uint64_t Session::send_motion(const Vector& place, const device::Reading& reading) noexcept {
  if (connection_.session() == 0 || !place.allFinite()) return 0;
  buttons_sent_ = reading.handle.buttons;
  const std::uint64_t sequence = forces_.note_sent(reading.latched);
  if (options_.local != nullptr) options_.local->note_motion(reading.latched);
  const wire::MotionSample motion{.session = connection_.session(),
                                  .sequence = sequence,
                                  .device_time = reading.latched,
                                  .position = place,
                                  .server_law_numbers = law().outgoing(),
                                  .pieces = options_.local ? options_.local->receipt() : wire::PieceReceipt{},
                                  .challenge = challenge(),
                                  .handle = reading.handle,
                                  .energy_given_J = energy_taken_ ? law().energy_given_J() : 0};
  if (!send(motion)) forces_.note_not_sent();
  return sequence;
}

std::uint64_t Session::challenge() const noexcept {
  const auto& newest = forces_.newest();
  return newest && newest->session == connection_.session() ? newest->challenge : 0;
}

bool Session::send(const wire::Message& message) noexcept {
  const bool sent = link_.send(codec_.encode(message), options_.server);
  if (!sent) ++counts_.send_failures;
  return sent;
}

void Session::keep_connected(Nanoseconds now) noexcept {
  connection_.on_blackout(now - silent_since_, options_.policy.hold, options_.policy.drop);
  if (link_.ready() && connection_.hello_due(now)) (void)send(connection_.hello(clock_.now()));
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

}  // namespace forcebound::client
