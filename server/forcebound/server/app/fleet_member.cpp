#include "forcebound/server/app/fleet_member.hpp"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include "forcebound/page/json_member.hpp"

namespace forcebound::server {
namespace {

using Json = nlohmann::json;
using namespace std::chrono_literals;

constexpr Nanoseconds kPauseFirst = 500ms;
constexpr Nanoseconds kPauseMost = 5s;
constexpr Nanoseconds kHealthMost = 5s;
constexpr Nanoseconds kHealthLeast = 500ms;
constexpr std::int64_t kLongestPeriod_s = 3600;

/// Numbers of 64 bits are texts there, those of 32 bits numbers.
std::optional<std::int64_t> whole(const Json& value) {
  if (value.is_number_integer()) return value.get<std::int64_t>();
  if (!value.is_string()) return std::nullopt;
  const auto text = value.get<std::string>();
  if (text.empty() || text.size() > 9 || !std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; })) {
    return std::nullopt;
  }
  return std::stoll(text);
}

/// The sidecar's REST has both spellings.
const Json& at(const Json& object, const char* name, const char* other_name) {
  return page::json_member(object, object.contains(name) ? name : other_name);
}

}  // namespace

std::optional<FleetState> read_fleet_state(std::string_view json) {
  const Json server = Json::parse(json, nullptr, false);
  const Json& state = at(at(server, "status", "status"), "state", "state");
  if (!state.is_string()) return std::nullopt;
  FleetState read{.allocated = state == "Allocated"};
  const Json& health = at(at(server, "spec", "spec"), "health", "health");
  const Json& disabled = at(health, "disabled", "disabled");
  const auto period_s = whole(at(health, "period_seconds", "periodSeconds"));
  if (period_s && *period_s > 0 && disabled != true) {
    read.health_period = std::chrono::seconds{std::min(*period_s, kLongestPeriod_s)};
  }
  return read;
}

void FleetMember::set_sessions(std::size_t sessions, Nanoseconds now) noexcept {
  if (sessions == 0 && sessions_ > 0) since_ = now;
  if (sessions > 0) used_ = true;
  sessions_ = sessions;
}

FleetCall FleetMember::life_cycle(Nanoseconds now) const noexcept {
  if (!reported_ready_) return FleetCall::ready;
  if (sessions_ > 0) return allocated_ ? FleetCall::none : FleetCall::allocate;
  if (!allocated_) return FleetCall::none;
  if (now < since_ + (used_ ? options_.empty : options_.arrival)) return FleetCall::none;
  return is_about_to_shut_down() ? FleetCall::shut_down : FleetCall::ready;
}

FleetCall FleetMember::next(Nanoseconds now, bool turning) const noexcept {
  if (shut_down_ || now < silent_until_) return FleetCall::none;
  if (leaving_) return FleetCall::shut_down;
  if (const FleetCall call = life_cycle(now); call != FleetCall::none) return call;
  if (now >= next_health_ && turning) return FleetCall::health;
  if (can_count_ && (counted_ != count() || now >= next_count_)) return FleetCall::count;
  return now >= next_look_ ? FleetCall::look : FleetCall::none;
}

void FleetMember::done(FleetCall call, Nanoseconds now) noexcept {
  pause_ = Nanoseconds{0};
  switch (call) {
    case FleetCall::ready:
      reported_ready_ = true;
      allocated_ = used_ = false;
      counted_.reset();
      reported_ = now;
      break;
    case FleetCall::allocate:
      allocated_ = used_ = true;
      reported_ = now;
      break;
    case FleetCall::shut_down:
      shut_down_ = true;
      break;
    case FleetCall::health:
      next_health_ = now + health_period_;
      break;
    case FleetCall::count:
      counted_ = count();
      next_count_ = now + options_.arrival;
      break;
    case FleetCall::look:
      next_look_ = now + options_.look;
      break;
    case FleetCall::none:
      break;
  }
}

void FleetMember::refused(FleetCall call) noexcept {
  if (call == FleetCall::count) can_count_ = false;
}

void FleetMember::failed(Nanoseconds now) noexcept {
  pause_ = std::clamp(2 * pause_, kPauseFirst, kPauseMost);
  silent_until_ = now + pause_;
}

void FleetMember::apply_state(const FleetState& state, Nanoseconds now) noexcept {
  // Twice in a period, so that one may be late.
  if (state.health_period > Nanoseconds{0}) {
    health_period_ = std::clamp(Nanoseconds{state.health_period / 2}, kHealthLeast, kHealthMost);
  }
  // What it shows may be from before it was told.
  if (!reported_ready_ || now < reported_ + options_.settle || state.allocated == allocated_) return;
  // Somebody else may have made it ready: the next turn allocates it again if it is in use.
  allocated_ = state.allocated;
  used_ = sessions_ > 0;
  since_ = now;
}

}  // namespace forcebound::server
