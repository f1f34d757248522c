#include "tests/support/drivers/inverse_service.hpp"

#include <cstdio>
#include <sstream>

namespace forcebound::test {
namespace {

using Json = nlohmann::json;

constexpr const char* kId = "04BA";
constexpr Axes kMiddle_m{0, -0.12, 0.15};  // of the device, from its base

Json vector_of(const Axes& axes) { return {{"x", axes[0]}, {"y", axes[1]}, {"z", axes[2]}}; }

/// Nothing unless x, y and z are numbers.
std::optional<Axes> axes_of(const Json& command, const char* spelling) {
  if (!command.is_object() || !command.contains(spelling)) return std::nullopt;
  const Json& given = command[spelling];
  Axes axes{};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const char* const name = std::array{"x", "y", "z"}.at(i);
    if (!given.is_object() || !given.contains(name) || !given[name].is_number()) return std::nullopt;
    axes.at(i) = given[name].get<double>();
  }
  return axes;
}

}  // namespace

std::string InverseService::begin_session() {
  const std::scoped_lock lock(guard_);
  ++sessions_;
  return instead_of(inventory());
}

void InverseService::end_session() {
  const std::scoped_lock lock(guard_);
  if (!keeps_) device_.command({});
}

std::string InverseService::answer(std::string_view message) {
  const std::scoped_lock lock(guard_);
  const Json asked = Json::parse(message.begin(), message.end(), nullptr, false);
  if (asked.is_object()) obey(asked);
  return instead_of(states());
}

void InverseService::obey(const Json& command) {
  const Json basis = command.value("/session/configure/basis/permutation"_json_pointer, Json());
  if (basis.is_string()) basis_ = basis.get<std::string>();
  if (!command.contains("inverse3") || !command["inverse3"].is_array()) return;
  for (const Json& device : command["inverse3"]) {
    if (!device.is_object() || device.value("device_id", "") != kId) continue;
    const Json force = device.value("/commands/set_cursor_force"_json_pointer, Json());
    const std::optional<Axes> vector = numbers_sessions_ ? axes_of(force, "vector") : std::nullopt;
    const std::optional<Axes> values = axes_of(force, "values");
    if (!vector && !values) continue;
    spelling_ = vector ? "vector" : "values";
    device_.command(vector ? *vector : *values);
  }
}

Json InverseService::inventory() {
  Json message = states();
  if (numbers_sessions_) message["session_id"] = sessions_;
  for (Json& device : message["inverse3"]) {
    device["config"] = {{"type", "inverse3"},
                        {"port", "COM12"},
                        {"handedness", "right"},
                        {"gravity_compensation", {{"enabled", true}, {"scaling_factor", 1.0}}},
                        {"torque_scaling", {{"enabled", true}}},
                        {"device_info", {{"major_version", 7}, {"minor_version", 4}, {"id", kId}}}};
  }
  return message;
}

Json InverseService::states() {
  Json message = {{"inverse3", Json::array()}};
  const std::optional<StandIn::State> state = device_.read();
  if (!state) {
    enabled_ = false;
    return message;
  }
  if (!enabled_) enabled_ = device_.enable(true);
  Axes position_m = kMiddle_m;
  for (std::size_t i = 0; i < position_m.size(); ++i) position_m.at(i) += state->position_m.at(i);
  const Json joints = {{"a0", 0.0}, {"a1", 0.0}, {"a2", 0.0}};
  message["inverse3"].push_back({{"device_id", kId},
                                 {"state",
                                  {{"cursor_position", vector_of(position_m)},
                                   {"cursor_velocity", vector_of({})},
                                   {"angular_position", joints},
                                   {"angular_velocity", joints},
                                   {"body_orientation", {{"w", 1.0}, {"x", 0.0}, {"y", 0.0}, {"z", 0.0}}},
                                   {"current_cursor_force", vector_of(state->force_N)},
                                   {"control_mode", "force"}}},
                                 {"status", {{"in_use", true}, {"power_supply", true}, {"ready", true}}}});
  add_grip(message, state->buttons);
  return message;
}

void InverseService::add_grip(Json& message, std::uint32_t buttons) const {
  if (grip_ == "none") return;
  const auto pressed = [&](unsigned k) { return (buttons >> k & 1U) != 0; };
  Json state = {{"orientation", {{"w", turn_[0]}, {"x", turn_[1]}, {"y", turn_[2]}, {"z", turn_[3]}}}, {"hall", 0}};
  if (grip_ == "wired") {
    state["button"] = pressed(0);
  } else {
    state["buttons"] = {{"a", pressed(0)}, {"b", pressed(1)}, {"c", pressed(2)}};
    state["battery_level"] = 0.5;
  }
  const char* const list = grip_ == "wired" ? "verse_grip" : "wireless_verse_grip";
  message[list] = Json::array({{{"device_id", "61548"}, {"state", std::move(state)}}});
}

std::string InverseService::instead_of(const Json& message) const { return said_.empty() ? message.dump() : said_; }

void InverseService::look(const std::string& text) {
  const StandIn::State now = device_.look();
  std::printf("look %s %.9g %.9g %.9g %s %s\n", text.c_str(), now.force_N[0], now.force_N[1], now.force_N[2],
              spelling_.c_str(), basis_.c_str());
  std::fflush(stdout);
}

bool InverseService::obey(const std::string& line) {
  const std::scoped_lock lock(guard_);
  std::istringstream words(line);
  std::string word;
  words >> word >> std::ws;
  const auto rest = [&] {
    std::string text;
    std::getline(words, text);
    return text;
  };
  if (word == "plug" || word == "unplug") {
    device_.plug(word == "plug");
  } else if (word == "press") {
    std::uint32_t mask = 0;
    words >> mask;
    device_.press(mask);
  } else if (word == "mute") {
    muted_ = true;
  } else if (word == "talk") {
    muted_ = false;
    muted_.notify_all();
    said_.clear();
  } else if (word == "keep") {
    keeps_ = true;
  } else if (word == "say") {
    said_ = rest();
  } else if (word == "say-bytes") {
    std::size_t count = 0;
    words >> count;
    said_.assign(count, '[');
  } else if (word == "grip") {
    grip_ = rest();
  } else if (word == "turn") {
    for (double& part : turn_) words >> part;
  } else if (word == "look") {
    look(rest());
  } else {
    return false;
  }
  return true;
}

}  // namespace forcebound::test
