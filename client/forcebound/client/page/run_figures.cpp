#include "forcebound/client/page/run_figures.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "forcebound/page/json_number.hpp"
#include "forcebound/record/run_info.hpp"

namespace forcebound::client {
namespace {

using Json = nlohmann::json;

constexpr double kMilli = 1e3;
constexpr double kMicro = 1e6;
// Rounding error of a sum of energies.
constexpr double kPassiveLeast_J = -1e-9;
constexpr double kMedian = 0.5;
constexpr double kRare = 0.99;
// More than a message ever holds at 60 Hz: ticks that came while nobody took them are left out.
constexpr std::size_t kWaitingMost = 4096;
constexpr std::size_t kUnusedMost = 1024;

/// Finite JSON number of nanoseconds in another unit, or null.
Json in_unit(double nanoseconds, double per_unit) {
  if (!std::isfinite(nanoseconds)) return nullptr;
  return nanoseconds / per_unit;
}

const char* words_of(record::SessionState state) noexcept {
  switch (state) {
    case record::SessionState::connecting:
      return "connecting";
    case record::SessionState::active:
      return "connected";
    case record::SessionState::stale:
      return "stale";
    case record::SessionState::reconnecting:
      return "reconnecting";
  }
  return "unknown";
}

/// Writes `,"key":[...]`, with what `add` adds for each tick.
template <class Add>
void add_column(std::string& to, const char* key, const std::vector<TickSample>& ticks, Add add) {
  to += ",\"";
  to += key;
  to += "\":[";
  for (const TickSample& tick : ticks) {
    if (&tick != ticks.data()) to += ',';
    add(tick);
  }
  to += ']';
}

}  // namespace

void StageHistogram::add(time::Nanoseconds duration) noexcept {
  const double ms = time::to_seconds(duration) * kMilli;
  const auto above = std::ranges::upper_bound(kEdges_ms, ms);
  const std::ptrdiff_t bin = std::distance(kEdges_ms.begin(), above) - 1;
  ++counts_[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(bin, 0, std::ssize(counts_) - 1))];
  durations_.add(duration.count());
}

std::string StageHistogram::to_json() const {
  std::string text = "{\"edges\":";
  page::add_numbers(text, std::span<const double>(kEdges_ms));
  text += ",\"counts\":[";
  for (std::size_t i = 0; i < counts_.size(); ++i) text += (i > 0 ? "," : "") + std::to_string(counts_[i]);
  text += "],\"median\":";
  page::add_number(text, durations_.percentile(kMedian) / kMicro);
  text += ",\"p99\":";
  page::add_number(text, durations_.percentile(kRare) / kMicro);
  return text + "}";
}

void RunFigures::add(const ForceSample& force) {
  if (force.session != session_) {
    session_ = force.session;
    motions_sent_ = std::max(motions_sent_, force.motion_sequence);
    forces_received_ = force_sequence_ = motion_answered_ = motions_received_ = 0;
    unused_.clear();
  }
  ++forces_received_;
  force_sequence_ = std::max(force_sequence_, force.sequence);
  motion_answered_ = std::max(motion_answered_, force.motion_sequence);
  motions_received_ = std::max(motions_received_, force.motions_received);
  round_trips_.add(force.round_trip.count());
  round_trip_s_.add(time::to_seconds(force.round_trip));
  at_server_s_.add(time::to_seconds(force.at_server));
  plane_ = force;
  if (unused_.size() < kUnusedMost) unused_.push_back(force);
}

void RunFigures::add(const TickSample& tick) {
  ++ticks_;
  if (tick.motion_sequence != 0) motions_sent_ = tick.motion_sequence;
  if (ticks_ > 1) {
    intervals_.add(tick.interval.count());
    late_ += tick.interval > options_.period + record::kLateBy ? 1U : 0U;
  }
  if (tick.force_sequence != 0) age_s_.add(time::to_seconds(tick.age));
  add_stages(tick);
  touched_ = touched_ || tick.contact || tick.asked_N != Axes{} || tick.applied_torque_N_m != Axes{};
  newest_ = tick;
  if (waiting_.size() < kWaitingMost) waiting_.push_back(tick);
}

/// When a force first reaches the device it has waited since it came.
void RunFigures::add_stages(const TickSample& tick) {
  if (tick.force_sequence == 0 || tick.force_sequence == last_used_) return;
  last_used_ = tick.force_sequence;
  const auto used = std::ranges::find(unused_, tick.force_sequence, &ForceSample::motion_sequence);
  if (used == unused_.end()) return;
  const time::Nanoseconds waited = std::max(time::Nanoseconds{0}, tick.time + tick.latency - used->received);
  network_stage_.add(used->round_trip - used->at_server);
  server_stage_.add(used->at_server);
  waiting_stage_.add(waited);
  total_stage_.add(used->round_trip + waited);
  unused_.erase(unused_.begin(), used + 1);
}

std::string RunFigures::take_ticks(int track, const std::optional<std::array<double, 3>>& hand_m) {
  if (waiting_.empty()) return {};
  const auto axes = static_cast<std::size_t>(options_.degrees_of_freedom);
  std::string text = "{\"kind\":\"ticks\",\"track\":" + std::to_string(track);
  const auto vector = [&](const Axes& value, bool known) {
    if (known) {
      page::add_numbers(text, std::span<const float>(value).first(axes));
    } else {
      text += "null";
    }
  };
  const auto number = [&](double value) { page::add_number(text, value); };
  constexpr int kTimeDigits = 12;
  add_column(text, "time_s", waiting_, [&](const TickSample& tick) {
    page::add_number(text, time::to_seconds(tick.time - options_.epoch), kTimeDigits);
  });
  add_column(text, "position_m", waiting_, [&](const TickSample& tick) { vector(tick.position_m, tick.usable); });
  add_column(text, "place_m", waiting_, [&](const TickSample& tick) { vector(tick.place_m, tick.has_place); });
  add_column(text, "asked_N", waiting_, [&](const TickSample& tick) { vector(tick.asked_N, true); });
  add_column(text, "applied_N", waiting_, [&](const TickSample& tick) { vector(tick.applied_N, true); });
  add_column(text, "age_ms", waiting_, [&](const TickSample& tick) {
    if (tick.force_sequence == 0) {
      text += "null";
    } else {
      number(time::to_seconds(tick.age) * kMilli);
    }
  });
  add_column(text, "ledger_mJ", waiting_, [&](const TickSample& tick) { number(tick.ledger_J * kMilli); });
  add_column(text, "passivity_mJ", waiting_, [&](const TickSample& tick) {
    if (options_.audited) {
      number(tick.audit_J * kMilli);
    } else {
      text += "null";
    }
  });
  add_column(text, "contact", waiting_, [&](const TickSample& tick) { text += tick.contact ? '1' : '0'; });
  add_handle(text);
  text += ",\"plane\":";
  if (plane_ && plane_->contact) {
    text += "{\"point_m\":";
    vector(plane_->surface_m, true);
    text += ",\"normal\":";
    vector(plane_->normal, true);
    text += '}';
  } else {
    text += "null";
  }
  text += ",\"hand_m\":";
  if (hand_m) {
    page::add_numbers(text, std::span<const double>(*hand_m).first(axes));
  } else {
    text += "null";
  }
  waiting_.clear();
  return text + "}";
}

/// Of a handle that tells its orientation. Once for all ticks of the message: a picture has no use for more.
void RunFigures::add_handle(std::string& to) const {
  if (!newest_ || !newest_->has_orientation) return;
  to += ",\"orientation\":";
  page::add_numbers(to, std::span<const double>(newest_->orientation));
  to += ",\"torque_N_m\":";
  page::add_numbers(to, std::span<const float>(newest_->applied_torque_N_m));
}

/// What is still on its way cannot be told from what is lost: motions after the newest that the server has answered
/// count as on their way.
RunFigures::Network RunFigures::network() const noexcept {
  const auto difference = [](std::uint64_t more, std::uint64_t less) { return more > less ? more - less : 0; };
  return {.sent = motions_sent_,
          .received = forces_received_,
          .lost_up = difference(motion_answered_, motions_received_),
          .lost_down = difference(force_sequence_, forces_received_),
          .in_flight = difference(motions_sent_, motion_answered_)};
}

std::optional<bool> RunFigures::passive() const noexcept {
  if (!options_.audited || !newest_) return std::nullopt;
  return newest_->audit_minimum_J >= kPassiveLeast_J;
}

std::string RunFigures::status(int track, std::uint64_t dropped, bool closing) const {
  const Network network = this->network();
  const auto passive = this->passive();
  Json message{{"kind", "status"},
               {"track", track},
               {"state", closing   ? "closing"
                         : newest_ ? words_of(newest_->state)
                                   : "connecting"},
               {"touched", touched_},
               {"passive", passive ? Json(*passive) : Json(nullptr)},
               {"least_passivity_mJ", passive ? Json(newest_->audit_minimum_J * kMilli) : Json(nullptr)}};
  // What the robot at the far end does, where there is one.
  const auto follower = plane_ ? plane_->follower : control::FollowerState::none;
  if (follower != control::FollowerState::none) message["robot"] = std::string(name_of(follower));
  message["network"] = {{"sent", network.sent},
                        {"received", network.received},
                        {"lost_up", network.lost_up},
                        {"lost_down", network.lost_down},
                        // Nobody here knows which half of its way a motion is on.
                        {"in_flight_up", (network.in_flight + 1) / 2},
                        {"in_flight_down", network.in_flight / 2}};
  message["network"]["round_trip_ms"] = nullptr;
  if (round_trips_.count() > 0) {
    message["network"]["round_trip_ms"] = {{"median", in_unit(round_trips_.percentile(kMedian), kMicro)},
                                           {"p99", in_unit(round_trips_.percentile(kRare), kMicro)}};
  }
  message["tick"] = {{"period_us",
                      {{"median", in_unit(intervals_.percentile(kMedian), kMilli)},
                       {"p99", in_unit(intervals_.percentile(kRare), kMilli)}}},
                     {"late", late_},
                     {"dropped_for_page", dropped}};
  Json& stages = message["stages_ms"] = Json::object();
  const auto add_stage = [&stages](const char* name, const StageHistogram& stage) {
    if (!stage.empty()) stages[name] = Json::parse(stage.to_json());
  };
  add_stage("network", network_stage_);
  add_stage("server", server_stage_);
  add_stage("waiting", waiting_stage_);
  add_stage("total", total_stage_);
  return message.dump();
}

void RunFigures::add_metrics(std::string& to, int track, std::uint64_t dropped) const {
  const auto add = [&](const char* name, const std::string& labels, double value) {
    to += "forcebound_client_" + std::string(name) + "{track=\"" + std::to_string(track) + "\"" + labels + "} ";
    constexpr int kDigits = 12;
    std::string number;
    page::add_number(number, value, kDigits);
    to += (number == "null" ? "NaN" : number) + "\n";
  };
  const Network network = this->network();
  constexpr double kSeconds = 1e9;
  add("ticks_total", "", static_cast<double>(ticks_));
  add("late_ticks_total", "", static_cast<double>(late_));
  add("page_dropped_total", "", static_cast<double>(dropped));
  add("motions_sent", "", static_cast<double>(network.sent));
  add("forces_received", "", static_cast<double>(network.received));
  add("lost", ",direction=\"up\"", static_cast<double>(network.lost_up));
  add("lost", ",direction=\"down\"", static_cast<double>(network.lost_down));
  add("period_seconds", ",quantile=\"0.5\"", intervals_.percentile(kMedian) / kSeconds);
  add("period_seconds", ",quantile=\"0.99\"", intervals_.percentile(kRare) / kSeconds);
  add("round_trip_seconds", ",quantile=\"0.5\"", round_trips_.percentile(kMedian) / kSeconds);
  add("round_trip_seconds", ",quantile=\"0.99\"", round_trips_.percentile(kRare) / kSeconds);
  const auto add_histogram = [&](const std::string& name, const page::DurationHistogram& histogram) {
    // Said once, before the first track's.
    if (track == 0) to += "# TYPE forcebound_client_scene_" + name + " histogram\n";
    const std::string scene = page::label_value(options_.scene.empty() ? "default" : options_.scene);
    histogram.write(to, "forcebound_client_scene_" + name, "track=\"" + std::to_string(track) + "\",scene=" + scene);
  };
  add_histogram("round_trip_seconds", round_trip_s_);
  add_histogram("at_server_seconds", at_server_s_);
  add_histogram("age_seconds", age_s_);
  if (!newest_) return;
  add("ledger_joules", "", newest_->ledger_J);
  if (!options_.audited) return;
  add("passivity_joules", "", newest_->audit_J);
  add("least_passivity_joules", "", newest_->audit_minimum_J);
}

}  // namespace forcebound::client
