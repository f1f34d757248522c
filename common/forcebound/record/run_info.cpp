#include "forcebound/record/run_info.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <stdexcept>
#include <string_view>

#include "forcebound/text/numbers.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::record {
namespace {

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
  for (const wire::MalformedRow& row : wire::kMalformed) {
    visit(std::string("malformed_") + row.name, totals.malformed[row.reason]);
  }
  each_fault(totals, [&](const char* name, auto& count, const char*, const char*) { visit(name, count); });
  for (const control::ReadingStatusRow& row : control::kReadingStatuses) {
    if (row.status != control::ReadingStatus::ok)
      visit(std::string("refused_") + row.name, totals.readings[row.status]);
  }
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
  visit("server_ahead_ns", totals.server_ahead);
  visit("server_ahead_off_ns", totals.server_ahead_off);
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
  return info;
}

RunTotals run_totals_from(const KeyValues& values, std::string* problem) {
  RunTotals totals;
  each_total(totals, InfoReader{values, problem});
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
  std::vector<Fault> faults;
  faults.reserve(wire::kMalformed.size());
  for (const wire::MalformedRow& row : wire::kMalformed) {
    faults.push_back({std::string("malformed_") + row.name, t.malformed[row.reason], row.one, row.many});
  }
  each_fault(t, [&](const char* name, std::uint64_t count, const char* one, const char* many) {
    faults.push_back({name, count, one, many});
  });
  for (const control::ReadingStatusRow& row : control::kReadingStatuses) {
    if (row.status == control::ReadingStatus::ok) continue;
    faults.push_back({std::string("refused_") + row.name, t.readings[row.status], row.one, row.many});
  }
  return faults;
}

}  // namespace forcebound::record
