#include "tests/lab/accuracy/study_markdown.hpp"

#include <limits>
#include <nlohmann/json.hpp>

#include "forcebound/text/numbers.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;

std::string percent(const Json& share) { return text::rounded(100 * share.get<double>()) + " %"; }

/// Of those that worked the least wrong; as many as there are settings if none did.
std::size_t best_behind(const Json& settings, std::size_t network) {
  std::size_t best = settings.size();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const double error = settings[i].at("behind").at(network).at("error");
    if (!settings[i].at("trouble").get<std::string>().empty() || error >= least) continue;
    best = i;
    least = error;
  }
  return best;
}

}  // namespace

std::string to_markdown(const Json& study) {
  const Json& settings = study.at("settings");
  const Json& networks = settings.at(0).at("behind");
  std::string text = "Reference: " + study.at("reference").at("why").get<std::string>() + ", uncertain to " +
                     percent(study.at("reference").at("uncertainty")) +
                     ". Hand: " + study.at("hand").get<std::string>() + ".\n\n| `" +
                     study.at("key").get<std::string>() + "` | a step [us] | model alone |";
  std::string rule = "|---|---|---|";
  for (const Json& network : networks) {
    text += " behind " + text::rounded(1e3 * network.at("round_trip_s").get<double>()) + " ms |";
    rule += "---|";
  }
  text += "\n" + rule + "\n";
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const Json& setting = settings[i];
    const std::string trouble = setting.at("trouble");
    text += "| " + setting.at("value").get<std::string>() + (trouble.empty() ? "" : ", failed: " + trouble) + " | " +
            text::rounded(setting.at("step_us").at("median").get<double>()) + " | " +
            percent(setting.at("force_error")) + " |";
    for (std::size_t network = 0; network < networks.size(); ++network) {
      const std::string mark = best_behind(settings, network) == i ? "**" : "";
      text += " " + mark + percent(setting.at("behind").at(network).at("error")) + mark + " |";
    }
    text += "\n";
  }
  return text;
}

}  // namespace forcebound::lab
