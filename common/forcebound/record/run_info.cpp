#include "forcebound/record/run_info.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "forcebound/text/numbers.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::record {
namespace {

constexpr std::array<const char*, wire::kMalformedReasons> kMalformedNames{"oversize", "truncated",  "foreign",
                                                                           "corrupt",  "unreadable", "non_finite"};

// The fields by name, once, for writing and for reading.
template <class Info, class Visit>
void each_field(Info& info, Visit&& visit) {
  visit("program", info.program);
  visit("law", info.law);
  visit("law_parameters", info.law_parameters);
  visit("device", info.device);
  visit("facts", info.facts);
  visit("operator", info.operator_name);
  visit("hand", info.hand);
  visit("scene", info.scene);
  visit("simulated", info.simulated);
  visit("rendering", info.rendering);
  visit("network", info.network);
  visit("encryption", info.encryption);
  visit("seed", info.seed);
  visit("period_ns", info.period);
  visit("hold_ns", info.hold);
  visit("drop_ns", info.drop);
  visit("epoch_ns", info.epoch);
  visit("audited", info.audited);
  visit("device_simulated", info.device_simulated);
  visit("surface_true", info.surface_true);
  visit("guarantee", info.guarantee);
  visit("settle_s", info.settle_s);
  visit("stiffness_depth_m_min", info.stiffness_depth_m_min);
  visit("force_N_max", info.force_N_max);
  visit("rounding_N", info.rounding_N);
}

template <class Totals, class Visit>
void each_total(Totals& totals, Visit&& visit) {
  visit("sent", totals.sent);
  visit("received", totals.received);
  visit("lost_up", totals.lost_up);
  visit("lost_down", totals.lost_down);
  visit("in_flight", totals.in_flight);
  visit("unanswered", totals.unanswered);
  visit("duplicated", totals.duplicated);
  visit("reordered", totals.reordered);
  for (std::size_t i = 0; i < kMalformedNames.size(); ++i) {
    visit(std::string("malformed_") + kMalformedNames[i], totals.malformed[i]);
  }
  visit("foreign_session", totals.foreign_session);
  visit("non_finite_requests", totals.non_finite_requests);
  for (const control::ReadingStatusRow& row : control::kReadingStatuses) {
    if (row.status != control::ReadingStatus::ok)
      visit(std::string("refused_") + row.name, totals.readings[row.status]);
  }
  visit("readings_too_far", totals.readings_too_far);
  visit("failed_writes", totals.failed_writes);
  visit("effects_outside_facts", totals.effects_outside_facts);
  visit("releases_outside_facts", totals.releases_outside_facts);
  visit("withdrawn_forces", totals.withdrawn_forces);
  visit("impossible_intervals", totals.impossible_intervals);
  visit("held_too_long", totals.held_too_long);
  visit("released_by_device", totals.released_by_device);
  visit("stale_readings", totals.stale_readings);
  visit("reconnects", totals.reconnects);
  visit("refusals", totals.refusals);
  visit("longest_blackout_ns", totals.longest_blackout.duration);
  visit("longest_blackout_over", totals.longest_blackout.over);
  visit("longest_blackout_counted", totals.longest_blackout.counted);
  visit("longest_blackout_server_left", totals.longest_blackout.server_left);
  visit("longest_blackout_motions", totals.longest_blackout.motions);
  visit("longest_blackout_lost_up", totals.longest_blackout.lost_up);
  visit("longest_blackout_answers", totals.longest_blackout.answers);
  visit("longest_blackout_lost_down", totals.longest_blackout.lost_down);
  visit("scene_pieces", totals.scene_pieces);
  visit("scene_piece_bytes", totals.scene_piece_bytes);
  visit("scenes_from_cache", totals.scenes_from_cache);
  visit("scenes_refused", totals.scenes_refused);
  visit("parts_quarantined", totals.parts_quarantined);
  visit("searches_exhausted", totals.searches_exhausted);
  visit("models_refused", totals.models_refused);
  visit("server_ahead_ns", totals.server_ahead);
  visit("server_ahead_off_ns", totals.server_ahead_off);
  visit("slew_bounded", totals.slew_bounded);
  visit("torque_slew_bounded", totals.torque_slew_bounded);
  visit("trips_of_speed", totals.trips_of_speed);
  visit("trips_of_turn", totals.trips_of_turn);
  visit("trips_of_workspace", totals.trips_of_workspace);
  visit("trips_of_heat", totals.trips_of_heat);
  visit("trips_of_dead_man", totals.trips_of_dead_man);
  visit("trips_of_frozen_readings", totals.trips_of_frozen_readings);
  visit("watchdog_stops", totals.watchdog_stops);
  visit("send_failures", totals.send_failures);
  visit("missed_ticks", totals.missed_ticks);
  visit("device_gaps_cut", totals.device_gaps_cut);
  visit("device_frozen_joints", totals.device_frozen_joints);
  visit("device_faulty_commands", totals.device_faulty_commands);
  visit("device_handle_refused", totals.device_handle_refused);
  visit("datagrams_overflowed", totals.datagrams_overflowed);
  visit("port_unreachable", totals.port_unreachable);
  visit("events_dropped", totals.events_dropped);
  visit("tick_allocations", totals.tick_allocations);
  visit("recording_dropped", totals.recording_dropped);
  visit("recording_unwritten", totals.recording_unwritten);
  visit("scene", totals.scene);
  visit("simulated", totals.simulated);
  visit("idle_timer_wake_ups", totals.idle_timer.wake_ups);
  visit("idle_timer_late", totals.idle_timer.late);
  visit("idle_timer_p50_us", totals.idle_timer.p50_us);
  visit("idle_timer_p99_us", totals.idle_timer.p99_us);
  visit("idle_timer_p999_us", totals.idle_timer.p999_us);
  visit("idle_timer_max_us", totals.idle_timer.max_us);
}

struct Writer {
  KeyValues& out;
  void operator()(const std::string& name, const std::string& value) { out[name] = value; }
  void operator()(const std::string& name, std::uint64_t value) { out[name] = std::to_string(value); }
  void operator()(const std::string& name, Nanoseconds value) { out[name] = std::to_string(value.count()); }
  void operator()(const std::string& name, const std::optional<Nanoseconds>& value) {
    if (value) (*this)(name, *value);
  }
  void operator()(const std::string& name, bool value) { out[name] = value ? "true" : "false"; }
  void operator()(const std::string& name, double value) { out[name] = text::to_text(value); }
};

template <class Number>
Number parse(const std::string& name, const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) {
    throw std::invalid_argument("field '" + name + "' must be a number, got '" + text + "'");
  }
  return value;
}

struct InfoReader {
  const KeyValues& in;
  std::string* problem;
  template <class Value>
  void operator()(const std::string& name, Value& value) {
    const auto found = in.find(name);
    if (found == in.end()) return;
    const Value standard = value;
    try {
      assign(name, found->second, value);
    } catch (const std::invalid_argument& error) {
      if (problem == nullptr) throw;
      value = standard;
      if (problem->empty()) *problem = error.what();
    }
  }
  static void assign(const std::string&, const std::string& text, std::string& value) { value = text; }
  static void assign(const std::string&, const std::string& text, bool& value) { value = text == "true"; }
  static void assign(const std::string& name, const std::string& text, Nanoseconds& value) {
    value = Nanoseconds{parse<Nanoseconds::rep>(name, text)};
    // As for the records' times: differences of accepted ones fit 64 bits.
    if (value > wire::kTimeMost || value < -wire::kTimeMost) {
      throw std::invalid_argument("field '" + name + "' must be within 2^61, got " + text);
    }
  }
  static void assign(const std::string& name, const std::string& text, std::optional<Nanoseconds>& value) {
    assign(name, text, value.emplace());
  }
  template <class Number>
  static void assign(const std::string& name, const std::string& text, Number& value) {
    value = parse<Number>(name, text);
  }
};

constexpr std::string_view kNotePrefix = "note_";

/// Names of fields in earlier recordings, and what they are called now.
constexpr std::array<std::pair<const char*, const char*>, 10> kRenamed{
    {{"nobody_listening", "port_unreachable"},
     {"overtaken", "unanswered"},
     {"longest_silence_ns", "longest_blackout_ns"},
     {"longest_silence_over", "longest_blackout_over"},
     {"longest_silence_counted", "longest_blackout_counted"},
     {"longest_silence_server_left", "longest_blackout_server_left"},
     {"longest_silence_motions", "longest_blackout_motions"},
     {"longest_silence_lost_up", "longest_blackout_lost_up"},
     {"longest_silence_answers", "longest_blackout_answers"},
     {"longest_silence_lost_down", "longest_blackout_lost_down"}}};

/// The same by present names; where both are there, the present one counts.
KeyValues by_present_names(KeyValues values) {
  for (const auto& [earlier, present] : kRenamed) {
    auto field = values.extract(earlier);
    if (field.empty()) continue;
    field.key() = present;
    values.insert(std::move(field));
  }
  return values;
}

}  // namespace

KeyValues to_key_values(const RunInfo& info) {
  KeyValues values;
  each_field(info, Writer{values});
  return values;
}

KeyValues to_key_values(const RunTotals& totals) {
  KeyValues values;
  each_total(totals, Writer{values});
  for (std::size_t i = 0; i < totals.notes.size(); ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "note_%06zu", i);  // sorts as it counts
    values[name] = totals.notes[i];
  }
  return values;
}

RunInfo run_info_from(const KeyValues& values, std::string* problem) {
  RunInfo info;
  each_field(info, InfoReader{values, problem});
  // Version 1 did not say it; only a simulated device knows P.
  if (!values.contains("device_simulated")) info.device_simulated = info.audited;
  return info;
}

RunTotals run_totals_from(const KeyValues& recorded, std::string* problem) {
  const KeyValues values = by_present_names(recorded);
  RunTotals totals;
  each_total(totals, InfoReader{values, problem});
  // Version 1 did not count it; it is the difference.
  const std::uint64_t elsewhere = totals.received + totals.lost_up + totals.lost_down;
  if (!values.contains("unanswered") && totals.sent > elsewhere) totals.unanswered = totals.sent - elsewhere;
  for (const auto& [name, text] : values) {
    if (name.starts_with(kNotePrefix)) totals.notes.push_back(text);
  }
  return totals;
}

MotionFates fates_of(const RunTotals& totals) noexcept {
  return {.sent = totals.sent,
          .answered = totals.received,
          .unanswered = totals.unanswered,
          .lost_up = totals.lost_up - std::min(totals.lost_up, totals.in_flight),
          .lost_down = totals.lost_down,
          .in_flight = std::min(totals.lost_up, totals.in_flight)};
}

std::string words_of(const MotionFates& fates) {
  return std::to_string(fates.sent) + " sent = " + std::to_string(fates.answered) + " answered + " +
         std::to_string(fates.unanswered) + " unanswered + " + std::to_string(fates.lost_up) + " lost up + " +
         std::to_string(fates.lost_down) + " lost down + " + std::to_string(fates.in_flight) + " in flight";
}

std::vector<Fault> faults_of(const RunTotals& t) {
  std::vector<Fault> faults{
      {"malformed_oversize", t.malformed[0], "datagram longer than the protocol allows",
       "datagrams longer than the protocol allows"},
      {"malformed_truncated", t.malformed[1], "datagram shorter than a frame header",
       "datagrams shorter than a frame header"},
      {"malformed_foreign", t.malformed[2], "datagram that is not ours, or of another version",
       "datagrams that are not ours, or of another version"},
      {"malformed_corrupt", t.malformed[3], "datagram whose checksum disagrees", "datagrams whose checksum disagrees"},
      {"malformed_unreadable", t.malformed[4], "datagram whose body cannot be read",
       "datagrams whose body cannot be read"},
      {"malformed_non_finite", t.malformed[5], "datagram with numbers that are not finite",
       "datagrams with numbers that are not finite"},
      {"foreign_session", t.foreign_session, "datagram of another session or sender",
       "datagrams of another session or sender"},
      {"non_finite_requests", t.non_finite_requests, "force asked for that was not finite, shown as zero",
       "forces asked for that were not finite, shown as zero"},
      {"readings_too_far", t.readings_too_far, "reading further away than the device can be, shown as zero force",
       "readings further away than the device can be, shown as zero force"},
      {"failed_writes", t.failed_writes, "command that may not have reached the motors",
       "commands that may not have reached the motors"},
      {"effects_outside_facts", t.effects_outside_facts,
       "force that the device reports in effect when its file does not allow it: the worst case is charged",
       "forces that the device reports in effect when its file does not allow it: the worst case is charged"},
      {"releases_outside_facts", t.releases_outside_facts,
       "release that the device reports when its file does not allow it: the worst case is charged",
       "releases that the device reports when its file does not allow them: the worst case is charged"},
      {"withdrawn_forces", t.withdrawn_forces, "force commanded too long after the reading, and made zero",
       "forces commanded too long after the reading, and made zero"},
      {"impossible_intervals", t.impossible_intervals, "tick whose clock stood still or ran back: nothing credited",
       "ticks whose clock stood still or ran back: nothing credited"},
      {"held_too_long", t.held_too_long, "tick beyond the hold time of a device that cannot let go: not passive",
       "ticks beyond the hold time of a device that cannot let go: not passive"},
      {"released_by_device", t.released_by_device, "tick so late that the device let go of the force",
       "ticks so late that the device let go of the force"},
      {"stale_readings", t.stale_readings, "tick without a new reading of the device, whose force was held on",
       "ticks without a new reading of the device, whose forces were held on"},
      {"reconnects", t.reconnects, "time the session was lost and requested again",
       "times the session was lost and requested again"},
      {"refusals", t.refusals, "request for a session that the server refused",
       "requests for a session that the server refused"},
      {"scenes_refused", t.scenes_refused, "scene of the server refused: its forces were held instead",
       "scenes of the server refused: their forces were held instead"},
      {"parts_quarantined", t.parts_quarantined,
       "part of the scene at the client whose force was not finite, left out from then on",
       "parts of the scene at the client whose forces were not finite, left out from then on"},
      {"searches_exhausted", t.searches_exhausted,
       "tick on which the scene at the client had too much of a mesh to search: its force was held instead",
       "ticks on which the scene at the client had too much of a mesh to search: its forces were held instead"},
      {"models_refused", t.models_refused, "local model of the server refused: its force was held instead",
       "local models of the server refused: their forces were held instead"},
      {"slew_bounded", t.slew_bounded, "tick on which --force-slew limited the change of the requested force",
       "ticks on which --force-slew limited the change of the requested force"},
      {"torque_slew_bounded", t.torque_slew_bounded,
       "tick on which --torque-slew limited the change of the requested torque",
       "ticks on which --torque-slew limited the change of the requested torque"},
      {"trips_of_speed", t.trips_of_speed, "time the hand was faster than the device's limit: no force meanwhile",
       "times the hand was faster than the device's limit: no force meanwhile"},
      {"trips_of_turn", t.trips_of_turn, "time the hand turned faster than the device's limit: no force meanwhile",
       "times the hand turned faster than the device's limit: no force meanwhile"},
      {"trips_of_workspace", t.trips_of_workspace, "time the hand left the device's workspace: the force faded",
       "times the hand left the device's workspace: the force faded"},
      {"trips_of_heat", t.trips_of_heat, "time the motors' load was above the device's limit: the force was bounded",
       "times the motors' load was above the device's limit: the force was bounded"},
      {"trips_of_dead_man", t.trips_of_dead_man, "time the dead-man button was not pressed: no force meanwhile",
       "times the dead-man button was not pressed: no force meanwhile"},
      {"trips_of_frozen_readings", t.trips_of_frozen_readings,
       "time readings of the device did not change, though the force on it had: no force meanwhile",
       "times readings of the device did not change, though the force on it had: no force meanwhile"},
      {"watchdog_stops", t.watchdog_stops, "time the device was stopped because the tick did not run",
       "times the device was stopped because the tick did not run"},
      {"send_failures", t.send_failures, "datagram the system did not take", "datagrams the system did not take"},
      {"missed_ticks", t.missed_ticks, "tick left out: the loop woke too late for it",
       "ticks left out: the loop woke too late for them"},
      {"device_gaps_cut", t.device_gaps_cut, "pause so long that the simulated device stood still in it",
       "pauses so long that the simulated device stood still in them"},
      {"device_frozen_joints", t.device_frozen_joints, "time the simulation of a joint's friction failed for 1 ms",
       "times the simulation of a joint's friction failed for 1 ms"},
      {"device_faulty_commands", t.device_faulty_commands, "command not finite at the device, shown as zero",
       "commands not finite at the device, shown as zero"},
      {"device_handle_refused", t.device_handle_refused,
       "orientation or gripper opening of the device that cannot be true, taken for absent",
       "orientations or gripper openings of the device that cannot be true, taken for absent"},
      {"datagrams_overflowed", t.datagrams_overflowed, "datagram lost here: the socket was full",
       "datagrams lost here: the socket was full"},
      {"port_unreachable", t.port_unreachable, "datagram refused by the server's machine: port unreachable (ICMP)",
       "datagrams refused by the server's machine: port unreachable (ICMP)"},
      {"events_dropped", t.events_dropped, "log line missing: the queue was full",
       "log lines missing: their queue was full"},
      {"tick_allocations", t.tick_allocations, "heap allocation inside the tick", "heap allocations inside the tick"},
      {"recording_dropped", t.recording_dropped, "record missing: the recorder's queue was full",
       "records missing: the recorder's queue was full"},
      {"recording_unwritten", t.recording_unwritten, "record missing: it could not be written",
       "records missing: they could not be written"}};
  for (const control::ReadingStatusRow& row : control::kReadingStatuses) {
    if (row.status == control::ReadingStatus::ok) continue;
    faults.push_back({std::string("refused_") + row.name, t.readings[row.status], row.one, row.many});
  }
  return faults;
}

}  // namespace forcebound::record
