#include "tests/tools/lab/accuracy/study_markdown.hpp"

#include <limits>
#include <nlohmann/json.hpp>

#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "tests/tools/lab/accuracy/study.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;

std::string percent(const Json& share) { return text::rounded(100 * share.get<double>()) + " %"; }

/// Errors below three times the reference's uncertainty are shown as that bound.
std::string percent_above(const Json& share, double uncertainty) {
  if (share.get<double>() >= 3 * uncertainty) return percent(share);
  return "<= " + text::rounded(300 * uncertainty) + " %";
}

bool is_passive(const Json& behind) {
  return behind.at("passivity_minimum_J").get<double>() >= -StudiedSetting::kRounding_J;
}

}  // namespace

std::size_t best_behind(const Json& study, std::size_t network) {
  const Json& settings = study.at("settings");
  const bool of_session = study.value("same_scene", false);
  std::size_t best = settings.size();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const Json& behind = settings[i].at("behind").at(network);
    const double error = behind.at("error");
    if (of_session && !is_passive(behind)) continue;
    if (!settings[i].at("trouble").get<std::string>().empty() || error >= least) continue;
    best = i;
    least = error;
  }
  return best;
}

std::string to_markdown(const Json& study) {
  const Json& settings = study.at("settings");
  const Json& networks = settings.at(0).at("behind");
  const double uncertainty = study.at("reference").at("uncertainty");
  const std::string trouble = study.at("reference").at("trouble");
  const std::string failed = trouble.empty() ? "" : " The reference itself failed: " + trouble + ".";
  std::vector<text::Table::Column> columns{
      {"`" + study.at("key").get<std::string>() + "`"}, {"a step", "us"}, {"model alone"}};
  for (const Json& network : networks)
    columns.push_back({"behind " + text::rounded(1e3 * network.at("round_trip_s").get<double>()) + " ms"});
  text::Table table(std::move(columns));
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const Json& setting = settings[i];
    const std::string failure = setting.at("trouble");
    std::vector<text::Table::Cell> row{
        setting.at("value").get<std::string>() + (failure.empty() ? "" : ", failed: " + failure),
        text::rounded(setting.at("step_us").at("median").get<double>()),
        percent_above(setting.at("force_error"), uncertainty)};
    for (std::size_t network = 0; network < networks.size(); ++network) {
      row.emplace_back(percent_above(setting.at("behind").at(network).at("error"), uncertainty),
                       best_behind(study, network) == i ? text::Table::Mark::best : text::Table::Mark::none);
    }
    table.add(std::move(row));
  }
  return "Reference: " + study.at("reference").at("why").get<std::string>() + ", uncertain to " +
         percent(study.at("reference").at("uncertainty")) + ". Hand: " + study.at("hand").get<std::string>() + "." +
         failed + "\n\n" + table.to_markdown();
}

}  // namespace forcebound::lab
