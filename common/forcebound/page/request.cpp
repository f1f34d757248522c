#include "forcebound/page/request.hpp"

#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "forcebound/page/json_member.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::page {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kShownMost = 40;

std::string shown(const Json& value) {
  const std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  return text::printable(text.substr(0, kShownMost));
}

[[noreturn]] void refuse(const std::string& key, const Json& value, const std::string& accepted) {
  throw std::invalid_argument(key + " is " + shown(value) + "; accepted is " + accepted);
}

double number_at(const Json& message, const char* key, double least, double most) {
  const Json& value = json_member(message, key);
  const bool fits = value.is_number() && std::isfinite(value.get<double>());
  if (!fits || value.get<double>() < least || value.get<double>() > most) {
    refuse(key, value, "a number from " + shown(least) + " to " + shown(most));
  }
  return value.get<double>();
}

bool flag_at(const Json& message, const char* key) {
  const Json& value = json_member(message, key);
  if (!value.is_boolean()) refuse(key, value, "true or false");
  return value.get<bool>();
}

std::uint64_t whole_at(const Json& message, const char* key) {
  const Json& value = json_member(message, key);
  if (!value.is_number_unsigned()) refuse(key, value, "a whole number from 0");
  return value.get<std::uint64_t>();
}

HandAt read_hand(const Json& message) {
  constexpr double kMost_m = 10;
  HandAt hand;
  const Json& point = json_member(message, "point_m");
  if (!point.is_array() || point.empty() || point.size() > hand.point_m.size()) {
    refuse("point_m", point, "a list of 1 to 3 numbers");
  }
  for (std::size_t i = 0; i < point.size(); ++i) {
    if (!point[i].is_number() || !(std::abs(point[i].get<double>()) <= kMost_m)) {
      refuse("point_m", point, "a list of numbers from -10 to 10");
    }
    hand.point_m[i] = point[i].get<double>();
  }
  return hand;
}

Button read_button(const Json& message) {
  constexpr double kLast = 31;
  return {.index = static_cast<int>(number_at(message, "index", 0, kLast)), .down = flag_at(message, "down")};
}

Network read_network(const Json& value) {
  constexpr double kDelayMost_ms = 5000;
  constexpr double kAll = 100;
  return {.delay_ms = number_at(value, "delay_ms", 0, kDelayMost_ms),
          .jitter_ms = number_at(value, "jitter_ms", 0, kDelayMost_ms),
          .loss_percent = number_at(value, "loss_percent", 0, kAll)};
}

Choose read_choice(const Json& message) {
  constexpr std::size_t kNameMost = 200;
  const Json& setting = json_member(message, "setting");
  if (!setting.is_string()) refuse("setting", setting, "a name");
  Choose choice{.setting = text::printable(setting.get<std::string>().substr(0, kNameMost))};
  const Json& value = json_member(message, "value");
  if (value.is_null()) return choice;
  if (value.is_string()) {
    choice.value = text::printable(value.get<std::string>().substr(0, kNameMost));
  } else if (value.is_number() && std::isfinite(value.get<double>())) {
    choice.value = value.get<double>();
  } else if (value.is_object()) {
    choice.value = read_network(value);
  } else {
    refuse("value", value, "a name, a number, null, or a network's delay_ms, jitter_ms and loss_percent");
  }
  return choice;
}

}  // namespace

std::optional<Request> read_request(std::string_view text) {
  constexpr double kTimeMost_s = 1e9;
  constexpr double kSpeedLeast = 0.01;
  constexpr double kSpeedMost = 100;
  const Json message = Json::parse(text, nullptr, false);
  if (!message.is_object()) throw std::invalid_argument("a message must be a JSON object");
  const Json& kind = json_member(message, "kind");
  if (!kind.is_string()) refuse("kind", kind, "a text");
  const auto& name = kind.get_ref<const std::string&>();
  if (name == "hand") return read_hand(message);
  if (name == "hand_free") return HandFree{};
  if (name == "button") return read_button(message);
  if (name == "choose") return read_choice(message);
  if (name == "record") return Record{flag_at(message, "on")};
  if (name == "kick") return Kick{whole_at(message, "session")};
  if (name == "seek") return Seek{number_at(message, "time_s", 0, kTimeMost_s)};
  if (name == "play") {
    const bool on = flag_at(message, "on");
    return Play{.on = on,
                .speed = message.contains("speed") ? number_at(message, "speed", kSpeedLeast, kSpeedMost) : 1};
  }
  return std::nullopt;
}

}  // namespace forcebound::page
