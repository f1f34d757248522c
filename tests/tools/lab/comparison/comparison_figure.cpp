#include "tests/tools/lab/comparison/comparison_figure.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/tools/lab/comparison/pareto.hpp"
#include "tests/tools/lab/comparison/trial.hpp"
#include "tests/tools/lab/figure.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;

// A force that never moves has no place on a logarithmic axis.
constexpr double kRippleLeast = 1e-4;
double number(const Json& value) { return value.is_number() ? value.get<double>() : std::nan(""); }

/// None, 10 ms and 50 ms, or what there is.
std::vector<std::size_t> shown_networks(const Json& all) {
  const std::size_t count = all.at("networks").size();
  std::vector<std::size_t> shown;
  for (const char* const name : {"none", "delay 10ms", "delay 50ms"}) {
    for (std::size_t i = 0; i < count; ++i) {
      if (all.at("networks").at(i) == name) shown.push_back(i);
    }
  }
  for (std::size_t i = 0; i < count && shown.empty(); ++i) shown.push_back(i);
  return shown;
}

Panel trade_panel(const Json& all, std::size_t network) {
  Panel panel{.title = "Network: " + all.at("networks").at(network).get<std::string>(),
              .y_label = "displayed over wanted stiffness"};
  std::vector<Trade> trades;
  for (const Json& law : all.at("laws")) {
    const Json& behind = law.at("behind").at(network);
    const double ripple = std::max(number(behind.at("ripple")), kRippleLeast);
    const double shown = number(behind.at("shown"));
    if (!std::isfinite(ripple) || !std::isfinite(shown)) continue;
    const bool sound = number(behind.at("calm")) >= 0.5 && number(behind.at("least_P_J")) >= kPassive_J;
    const std::string name = law.at("law");
    panel.series.push_back({.label = "",
                            .x = {ripple},
                            .y = {shown},
                            .colour = colour::of_law(name),
                            .mark = sound ? Series::Mark::dot : Series::Mark::cross,
                            .names = {name}});
    // A wall that is shown stiffer than it is, is no better shown.
    trades.push_back({.less = sound ? ripple : std::nan(""), .more = std::min(shown, 1.0)});
  }
  Series front{.label = "", .colour = colour::kAudit, .mark = Series::Mark::ring};
  for (const std::size_t i : pareto_front(trades)) {
    front.x.push_back(panel.series[i].x.front());
    front.y.push_back(panel.series[i].y.front());
  }
  panel.series.push_back(std::move(front));
  return panel;
}

}  // namespace

void draw_comparison(const Json& all, const std::filesystem::path& png) {
  Figure figure{.title = "Stability against transparency",
                .subtitle =
                    "medians over scenes and walls, real device; ring: no other law beats it; cross: no rest, or "
                    "not passive",
                .x_label = "restlessness: deviation of the force over its mean"};
  figure.x_log = true;
  for (const std::size_t network : shown_networks(all)) figure.panels.push_back(trade_panel(all, network));
  draw(figure, png);
}

namespace {

constexpr double kDelayLeast_ms = 0.1;

/// One curve over the delays.
template <typename Stiffness>
Series limit_curve(const Json& limits, const std::string& label, const char* colour, Stiffness stiffness_N_per_m) {
  Series series{.label = label, .colour = colour, .mark = Series::Mark::dot};
  for (std::size_t i = 0; i < limits.size(); ++i) {
    series.x.push_back(std::max(1e3 * number(limits.at(i).at("delay_s")), kDelayLeast_ms));
    series.y.push_back(1e-3 * stiffness_N_per_m(i));
  }
  return series;
}

Panel limits_panel(const Json& all, std::size_t hand) {
  Panel panel{.title = "Under a " + all.at("hands").at(hand).at("hand").get<std::string>() + " hand",
              .y_label = "stiffness [N/mm]",
              .y_log = true};
  const Json& limits = all.at("limits");
  const auto theory = [&](const char* key) { return [&, key](std::size_t i) { return number(limits.at(i).at(key)); }; };
  panel.series.push_back(limit_curve(limits, "2b/T", colour::kRequest, theory("passive_N_per_m")));
  panel.series.push_back(limit_curve(limits, "b/(T/2 + 2t)", colour::kRequest, theory("delayed_N_per_m")));
  for (Series& series : panel.series) series.width = 5;
  for (const Json& law : all.at("laws")) {
    const std::string name = law.at("law");
    panel.series.push_back(limit_curve(limits, hand == 0 ? name : "", colour::of_law(name), [&](std::size_t i) {
      return number(law.at("stable").at(i).at(hand).at("N_per_m"));
    }));
  }
  if (hand > 0) {
    for (Series& series : panel.series) series.label.clear();
  }
  panel.references.push_back({1e-3 * number(limits.at(0).at("free_N_per_m")), hand == 0 ? "free device" : ""});
  return panel;
}

}  // namespace

void draw_limits(const Json& all, const std::filesystem::path& png) {
  // No subtitle: so many laws need its room to be named.
  Figure figure{
      .title = "The stiffest wall that comes to rest, up to 1000 N/mm; ideal device of 30 N s/m; thick: theory",
      .x_label = "delay each way [ms]; the least drawn stands for none"};
  figure.x_log = true;
  for (std::size_t hand = 0; hand < all.at("hands").size(); ++hand) figure.panels.push_back(limits_panel(all, hand));
  draw(figure, png);
}

}  // namespace forcebound::lab
