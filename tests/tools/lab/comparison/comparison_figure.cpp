#include "tests/tools/lab/comparison/comparison_figure.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "forcebound/results/draw.hpp"
#include "forcebound/text/table.hpp"
#include "tests/tools/lab/comparison/pareto.hpp"
#include "tests/tools/lab/comparison/trial.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;

double number(const Json& value) { return value.is_number() ? value.get<double>() : std::nan(""); }

struct Standing {
  std::string law;
  double restlessness;  ///< not a number without contact
  double shown;         ///< not a number where no contact rests
  bool sound;           ///< contacts mostly rest, passive
};

std::vector<Standing> standings_behind(const Json& laws, std::size_t network) {
  std::vector<Standing> all;
  for (const Json& law : laws) {
    const Json& behind = law.at("behind").at(network);
    const double restlessness = number(behind.at("ripple"));
    const double shown = number(behind.at("shown"));
    if (!std::isfinite(restlessness) && !std::isfinite(shown)) continue;  // it refused to play
    all.push_back({.law = law.at("law"),
                   .restlessness = restlessness,
                   .shown = shown,
                   .sound = std::isfinite(restlessness) && std::isfinite(shown) && number(behind.at("calm")) >= 0.5 &&
                            number(behind.at("least_P_J")) >= kPassive_J});
  }
  return all;
}

std::vector<std::size_t> unbeaten(const std::vector<Standing>& all) {
  std::vector<Trade> trades;
  trades.reserve(all.size());
  for (const Standing& standing : all) {
    // A wall shown stiffer than it is counts as 1.
    trades.push_back(
        {.less = standing.sound ? standing.restlessness : std::nan(""), .more = std::min(standing.shown, 1.0)});
  }
  return pareto_front(trades);
}

}  // namespace

std::string comparison_csv(const Json& standings) {
  text::Table table(
      {{"network"}, {"law"}, {"displayed_over_requested"}, {"restlessness"}, {"rests_and_passive"}, {"unbeaten"}});
  const Json& networks = standings.at("networks");
  for (std::size_t network = 0; network < networks.size(); ++network) {
    const auto all = standings_behind(standings.at("laws"), network);
    const auto best = unbeaten(all);
    for (std::size_t i = 0; i < all.size(); ++i) {
      table.add({networks[network].get<std::string>(), all[i].law, results::figure_number(all[i].shown),
                 results::figure_number(all[i].restlessness), all[i].sound ? "1" : "0",
                 std::ranges::count(best, i) > 0 ? "1" : "0"});
    }
  }
  return table.to_csv();
}

std::string limits_csv(const Json& standings) {
  text::Table table({{"hand"}, {"delay_ms"}, {"law"}, {"stiffness_N_per_mm"}});
  const Json& limits = standings.at("limits");
  const Json& hands = standings.at("hands");
  for (std::size_t hand = 0; hand < hands.size(); ++hand) {
    for (std::size_t i = 0; i < limits.size(); ++i) {
      const auto add = [&](const std::string& law, const Json& stiffness_N_per_m) {
        table.add({hands[hand].at("hand").get<std::string>(),
                   results::figure_number(1e3 * number(limits[i].at("delay_s"))), law,
                   results::figure_number(1e-3 * number(stiffness_N_per_m))});
      };
      add("2b/T", limits[i].at("passive_N_per_m"));
      add("b/(T/2 + 2t)", limits[i].at("delayed_N_per_m"));
      for (const Json& law : standings.at("laws")) {
        add(law.at("law"), law.at("stable").at(i).at(hand).at("N_per_m"));
      }
    }
  }
  return table.to_csv();
}

}  // namespace forcebound::lab
