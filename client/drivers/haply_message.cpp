#include "haply_message.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>

namespace forcebound::haply {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kIdBytesMost = 64;
constexpr double kPosition_m_most = 10;
constexpr std::array<const char*, 3> kGrips{"verse_grip", "wireless_verse_grip", "custom_verse_grip"};

/// Null: there is none.
const Json* member(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found == object.end() ? nullptr : &*found;
}

const Json* object_of(const Json& object, const char* name) {
  const Json* const value = member(object, name);
  return value != nullptr && value->is_object() ? value : nullptr;
}

const Json* list_of(const Json& object, const char* name) {
  const Json* const value = member(object, name);
  return value != nullptr && value->is_array() ? value : nullptr;
}

/// Empty: it has none, or one that we could not send back.
std::string id_of(const Json& device) {
  const Json* const id = member(device, "device_id");
  if (id == nullptr || !id->is_string()) return {};
  const auto& text = id->get_ref<const std::string&>();
  return is_device_id(text) ? text : std::string();
}

template <std::size_t count>
bool read_numbers(const Json& object, const std::array<const char*, count>& names, std::array<double, count>& numbers) {
  std::array<double, count> read{};
  for (std::size_t i = 0; i < count; ++i) {
    const Json* const number = member(object, names.at(i));
    if (number == nullptr || !number->is_number()) return false;
    read.at(i) = number->get<double>();
    if (!std::isfinite(read.at(i))) return false;
  }
  numbers = read;
  return true;
}

bool read_position(const Json& device, Axes& position_m) {
  const Json* const state = object_of(device, "state");
  const Json* const position = state != nullptr ? object_of(*state, "cursor_position") : nullptr;
  Axes read{};
  if (position == nullptr || !read_numbers<3>(*position, {"x", "y", "z"}, read)) return false;
  if (std::ranges::any_of(read, [](double x) { return std::abs(x) > kPosition_m_most; })) return false;
  position_m = read;
  return true;
}

void read_orientation(const Json& grip, State& state) {
  const Json* const orientation = object_of(grip, "orientation");
  std::array<double, 4> q{};
  if (orientation == nullptr || !read_numbers<4>(*orientation, {"w", "x", "y", "z"}, q)) return;
  const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  // What is far from a rotation is none: a grip that has not measured yet tells zeros.
  constexpr double kTolerance = 0.1;
  if (std::abs(norm - 1) > kTolerance) return;
  for (double& part : q) part /= norm;
  state.orientation = q;
  state.has_orientation = true;
}

bool is_true(const Json* value) { return value != nullptr && value->is_boolean() && value->get<bool>(); }

/// A wired grip has one `button`, a wireless one `buttons` by letter or by number.
void read_buttons(const Json& grip, State& state) {
  if (const Json* const one = member(grip, "button"); one != nullptr && one->is_boolean()) {
    state.buttons = is_true(one) ? 1U : 0U;
    state.has_buttons = true;
    return;
  }
  const Json* const several = object_of(grip, "buttons");
  if (several == nullptr) return;
  constexpr std::array<std::array<const char*, 2>, 4> kNames{
      {{"a", "button_0"}, {"b", "button_1"}, {"c", "button_2"}, {"d", "button_3"}}};
  state.buttons = 0;
  for (std::size_t k = 0; k < kNames.size(); ++k) {
    const bool pressed = std::ranges::any_of(kNames.at(k), [&](const char* n) { return is_true(member(*several, n)); });
    if (pressed) state.buttons |= 1U << k;
  }
  state.has_buttons = true;
}

void read_grip(const Json& message, State& state) {
  for (const char* const kind : kGrips) {
    const Json* const grips = list_of(message, kind);
    if (grips == nullptr || grips->empty() || !grips->front().is_object()) continue;
    const Json* const grip = object_of(grips->front(), "state");
    if (grip == nullptr) continue;
    read_orientation(*grip, state);
    read_buttons(*grip, state);
    return;
  }
}

Json parsed(std::string_view text) { return Json::parse(text.begin(), text.end(), nullptr, false); }

}  // namespace

bool is_device_id(std::string_view text) {
  constexpr std::string_view kAccepted = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz-_";
  return !text.empty() && text.size() <= kIdBytesMost && text.find_first_not_of(kAccepted) == std::string_view::npos;
}

std::optional<Inventory> parse_inventory(std::string_view text) {
  const Json message = parsed(text);
  if (!message.is_object()) return std::nullopt;
  const Json* const devices = list_of(message, "inverse3");
  Inventory inventory;
  inventory.has_sessions = message.contains("session_id");
  // A service without any device may leave the list out.
  if (devices == nullptr) return message.empty() || inventory.has_sessions ? std::optional(inventory) : std::nullopt;
  for (const Json& device : *devices) {
    const std::string id = id_of(device);
    if (!id.empty()) inventory.device_ids.push_back(id);
  }
  return inventory;
}

Answer parse_state(std::string_view text, const std::string& device_id, State& state) {
  const Json message = parsed(text);
  if (!message.is_object()) return Answer::not_understood;
  const Json* const devices = list_of(message, "inverse3");
  if (devices == nullptr) return Answer::not_understood;
  const auto device = std::ranges::find_if(*devices, [&](const Json& one) { return id_of(one) == device_id; });
  if (device == devices->end()) return Answer::gone;
  State read;
  if (!read_position(*device, read.position_m)) return Answer::not_understood;
  read_grip(message, read);
  state = read;
  return Answer::state;
}

void write_command(const Command& command, std::string& text) {
  text = "{";
  if (command.introduces) {
    text += R"("session":{"configure":{"profile":{"name":"forcebound"},"basis":{"permutation":"XYZ"}}},)";
  }
  text.append(R"("inverse3":[{"device_id":")").append(command.device_id);
  text.append(R"(","commands":{"set_cursor_force":{")");
  text.append(command.spelling == Spelling::values ? "values" : "vector");
  const char* before = R"(":{"x":)";
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), command.force_N[axis],
                                   std::chars_format::general, 9);
    text.append(before).append(digits.data(), end.ptr);
    before = axis == 0 ? R"(,"y":)" : R"(,"z":)";
  }
  text.append("}}}}]}");
}

}  // namespace forcebound::haply
