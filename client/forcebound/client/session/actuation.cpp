#include "forcebound/client/session/actuation.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "forcebound/control/assertion.hpp"
#include "forcebound/control/translation.hpp"
#include "forcebound/control/wrench.hpp"

namespace forcebound::client {
namespace {

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

Actuation::Actuation(device::HapticDevice& device, std::unique_ptr<control::PassivityLaw> law, const time::Clock& clock,
                     EventReporter& events)
    : device_(device),
      clock_(clock),
      events_(events),
      bounder_(device.facts(), std::move(law)),
      times_(device),
      safety_(device.safety(), device.facts().force_N_max, device.facts().torque_N_m_max),
      unseen_(device.facts(), safety_.limits()),
      last_applied_(Vector::Zero(device.facts().degrees_of_freedom())) {}

std::optional<device::Reading> Actuation::read(Nanoseconds now) noexcept {
  device::Reading reading = device_.read(now);
  reading = device::usable_or_lost(reading, device_.facts(), now, std::max(now, clock_.now()));
  report_presence(reading.status, now);
  if (times_.is_held_on(reading, now)) {
    ++counts_.stale_readings;
    return std::nullopt;
  }
  ++counts_.readings[reading.status];
  report_missing_torque(reading, now);
  return reading;
}

void Actuation::report_presence(device::Reading::Status status, Nanoseconds now) noexcept {
  const DeviceWatch::Change change = watch_.change_on(status == device::Reading::Status::ok, now);
  const bool by_device = status == device::Reading::Status::failed;
  const std::string_view own = by_device ? device_.last_error() : std::string_view{};
  if (change == DeviceWatch::Change::gone)
    events_.report(Event::Kind::device_gone, now, own.empty() ? control::why(status) : own);
  if (change == DeviceWatch::Change::back) events_.report(Event::Kind::device_back, now, {}, watch_.pause());
}

/// The handle turns by the hand alone.
void Actuation::report_missing_torque(const device::Reading& reading, Nanoseconds now) noexcept {
  if (missing_torque_reported_ || device_.facts().rotations > 0 || !reading.handle.orientation) return;
  missing_torque_reported_ = true;
  events_.report(Event::Kind::no_torque, now, device_.facts().name);
}

double Actuation::begin_choosing(const device::Reading& reading) noexcept {
  times_.begin_choosing(clock_.now());
  return time::to_seconds(interval_until(reading));
}

Nanoseconds Actuation::interval_until(const device::Reading& reading) const noexcept {
  const auto previous = times_.previous_reading();
  return previous ? reading.latched - *previous : Nanoseconds::zero();
}

Actuation::Command Actuation::command(Nanoseconds now, const device::Reading& reading, const Wanted& wanted) noexcept {
  Command command{.interval = interval_until(reading)};
  limit_for_hand(now, reading, wanted, command);
  const Vector force = chosen(reading, command, wanted.silent);
  const Nanoseconds commanded = clock_.now();
  command.latency = commanded - reading.latched;
  last_applied_ = bounder_.confirmed(force, times_.command_at(reading, commanded));
  FORCEBOUND_ASSERT(last_applied_.rows() == device_.facts().degrees_of_freedom() && last_applied_.allFinite(),
                    "a force on its way to the device is finite, with a row for each degree of freedom");
  device_.apply(commanded, last_applied_);

  command.applied_N = last_applied_.head(device_.facts().translations());
  if (device_.facts().rotations > 0) command.applied_torque_N_m = last_applied_.tail<3>();
  command.energy_J = law().energy_J();
  command.xi = law().xi();
  command.audit = device_.audit();
  return command;
}

void Actuation::limit_for_hand(Nanoseconds now, const device::Reading& reading, const Wanted& wanted,
                               Command& command) noexcept {
  const double elapsed_s = time::to_seconds(command.interval);
  if (reading.position.allFinite()) unseen_.add(reading, last_applied_, elapsed_s);
  const Vector applied_N = last_applied_.head(device_.facts().translations());
  HandSafety::Tick tick{.position = reading.position,
                        .applied_N = applied_N,
                        .elapsed_s = elapsed_s,
                        .handle = reading.handle,
                        .believed = unseen_.share(),
                        .frozen = unseen_.frozen()};
  const bool shows_torque = device_.facts().rotations > 0;
  if (shows_torque) tick.applied_N_m = last_applied_.tail<3>();
  command.request_N = safety_.limited(wanted.force_N, tick);
  if (shows_torque) command.request_torque_N_m = safety_.limited_torque(wanted.torque_N_m);
  if (const auto trip = safety_.take_trip()) events_.report(Event::Kind::limited_for_safety, now, words_of(*trip));
}

Vector Actuation::chosen(const device::Reading& reading, const Command& command, bool silent) noexcept {
  const control::DeviceFacts& facts = device_.facts();
  const control::Motion motion = times_.motion_at(reading);
  counts_.released_by_device += motion.held_s < motion.interval_s;
  counts_.held_too_long += !facts.releases && motion.interval_s - motion.latency_s > facts.hold_s_max;
  if (silent) return bounder_.release(motion);
  const Eigen::Vector3d torque_N_m = control::translation_of(command.request_torque_N_m);
  return bounder_.tick(motion, control::wrench_of(command.request_N, torque_N_m, facts.rotations));
}

void Actuation::add_to(record::RunTotals& totals) const {
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
  const control::ForceBounder::Counts& law = bounder_.counts();
  totals.non_finite_requests = law.requests_not_finite;
  totals.impossible_intervals = law.intervals_impossible;
  totals.withdrawn_forces = law.withdrawn;
  totals.law_faults = law.forces_not_finite;
  totals.readings_too_far = law.readings_too_far;
  totals.failed_writes = law.writes_failed;
  totals.effects_outside_facts = law.effects_outside_facts;
  totals.releases_outside_facts = law.releases_outside_facts;
  totals.trips_of_speed = safety_.trips(HandSafety::Trip::speed);
  totals.trips_of_turn = safety_.trips(HandSafety::Trip::turn);
  totals.trips_of_workspace = safety_.trips(HandSafety::Trip::workspace);
  totals.trips_of_heat = safety_.trips(HandSafety::Trip::heat);
  totals.trips_of_dead_man = safety_.trips(HandSafety::Trip::dead_man);
  totals.trips_of_frozen_readings = safety_.trips(HandSafety::Trip::frozen);
}

}  // namespace forcebound::client
