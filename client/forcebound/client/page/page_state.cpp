#include "forcebound/client/page/page_state.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::client {
namespace {

using Json = nlohmann::json;

std::string dumped(const Json& message) { return message.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string got(const page::Choose& choice) {
  if (const auto* const number = std::get_if<double>(&choice.value)) return text::to_text(*number);
  if (const auto* const name = std::get_if<std::string>(&choice.value)) return "'" + *name + "'";
  return std::holds_alternative<std::monostate>(choice.value) ? "no value" : "a network";
}

std::string chosen_name(const page::Choose& choice, const std::vector<std::string>& names) {
  const auto* const name = std::get_if<std::string>(&choice.value);
  if (names.empty()) throw std::invalid_argument(choice.setting + " cannot be chosen here");
  if (name == nullptr) throw std::invalid_argument(choice.setting + " must be a name, got " + got(choice));
  if (std::ranges::find(names, *name) == names.end()) {
    throw std::invalid_argument("unknown " + choice.setting + " '" + *name + "'" + text::suggestion(*name, names));
  }
  return *name;
}

}  // namespace

PageChoice changed(const PageChoice& now, const page::Choose& choice, const PageChoices& choices) {
  PageChoice next = now;
  std::vector<std::string> laws;
  for (const LawChoice& law : choices.laws) laws.push_back(law.name);
  if (choice.setting == "law") {
    next.law = chosen_name(choice, laws);
  } else if (choice.setting == "law_beside") {
    if (!choices.beside) throw std::invalid_argument("a law beside needs a simulated device");
    next.law_beside.reset();
    if (!std::holds_alternative<std::monostate>(choice.value)) next.law_beside = chosen_name(choice, laws);
  } else if (choice.setting == "scene") {
    const bool servers_default = std::holds_alternative<std::monostate>(choice.value) && !choices.scenes.empty();
    next.scene = servers_default ? std::string() : chosen_name(choice, choices.scenes);
  } else if (choice.setting == "device") {
    next.device = chosen_name(choice, choices.devices);
  } else if (choice.setting == "stiffness_N_per_m") {
    const auto* const value = std::get_if<double>(&choice.value);
    if (!choices.stiffness) throw std::invalid_argument("the stiffness is that of a simulated hand, which is not here");
    if (value == nullptr || *value < kHandStiffnessLeast || *value > kHandStiffnessMost) {
      throw std::invalid_argument("the hand's stiffness must be a number from 10 to 5000 N/m, got " + got(choice));
    }
    next.stiffness_N_per_m = *value;
  } else {
    std::vector<std::string> settings;
    settings.reserve(kSettings.size());
    for (const Setting& setting : kSettings) settings.emplace_back(setting.name);
    throw std::invalid_argument("unknown setting '" + choice.setting + "'" +
                                text::suggestion(choice.setting, settings));
  }
  return next;
}

std::string hello_message(const PageState& state, double time_s) {
  Json laws = Json::array();
  for (const LawChoice& law : state.choices.laws) laws.push_back({{"name", law.name}, {"about", law.about}});
  Json settings{{"law", state.choice.law}, {"scene", state.choice.scene}, {"device", state.choice.device}};
  settings["law_beside"] = state.choice.law_beside ? Json(*state.choice.law_beside) : Json(nullptr);
  settings["stiffness_N_per_m"] =
      state.choice.stiffness_N_per_m ? Json(*state.choice.stiffness_N_per_m) : Json(nullptr);
  settings["network"] = nullptr;
  if (state.network) {
    settings["network"] = {{"delay_ms", state.network->delay_ms},
                           {"jitter_ms", state.network->jitter_ms},
                           {"loss_percent", state.network->loss_percent}};
  }
  Json tracks = Json::array({{{"law", state.choice.law}}});
  if (state.choice.law_beside) tracks.push_back({{"law", *state.choice.law_beside}});
  Json message{{"kind", "hello"},
               {"protocol", 1},
               {"program", "client"},
               {"version", FORCEBOUND_VERSION},
               {"time_s", time_s},
               {"period_s", state.period_s},
               {"dof", state.degrees_of_freedom},
               {"simulated", state.simulated},
               {"pointer", state.pointer},
               {"may_change", true},
               {"choices", {{"laws", laws}, {"scenes", state.choices.scenes}, {"devices", state.choices.devices}}},
               {"settings", settings},
               {"recording", state.recording_file.empty() ? Json(nullptr) : Json(state.recording_file)},
               {"duration_s", nullptr},
               {"tracks", tracks},
               {"read_only", false}};
  if (state.replay) {
    message["program"] = "view";
    message["may_change"] = false;
    message["recording"] = state.replay->file;
    message["duration_s"] = state.replay->duration_s;
    message["playing"] = state.replay->playing;
    message["speed"] = state.replay->speed;
  }
  return dumped(message);
}

std::string event_message(int track, double time_s, const std::string& level, const std::string& text) {
  return dumped({{"kind", "event"}, {"track", track}, {"time_s", time_s}, {"level", level}, {"text", text}});
}

std::string refused_message(const std::string& about, const std::string& text) {
  return dumped({{"kind", "refused"}, {"about", about}, {"text", text}});
}

}  // namespace forcebound::client
