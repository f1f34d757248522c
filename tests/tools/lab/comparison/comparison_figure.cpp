#include "tests/tools/lab/comparison/comparison_figure.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "forcebound/text/numbers.hpp"
#include "tests/tools/lab/comparison/pareto.hpp"
#include "tests/tools/lab/comparison/trial.hpp"
#include "tests/tools/lab/figure.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;

// A constant force has restlessness zero, which has no place on a logarithmic axis.
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
              .y_label = "displayed over requested stiffness"};
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
    // A wall shown stiffer than it is counts as 1.
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

// Not even the softest wall tried is stable: a mark on the lower edge, since a logarithmic axis has no zero.
constexpr double kNone_N_per_mm = 0.05;
constexpr double kLowest_N_per_mm = 0.035;
constexpr double kHighest_N_per_mm = 1800;

/// Marks side by side within each delay's place, so that none hides another.
template <typename Stiffness>
Series limit_marks(const Json& limits, const std::string& label, const char* colour, double aside,
                   Stiffness stiffness_N_per_m) {
  Series series{.label = label, .colour = colour, .width = 2, .mark = Series::Mark::dot, .joined = false};
  for (std::size_t i = 0; i < limits.size(); ++i) {
    series.x.push_back(static_cast<double>(i + 1) + aside);
    series.y.push_back(std::max(1e-3 * stiffness_N_per_m(i), kNone_N_per_mm));
  }
  return series;
}

/// A line across each delay's place.
template <typename Stiffness>
Series theory_lines(const Json& limits, const std::string& label, const char* colour, Stiffness stiffness_N_per_m) {
  Series series{.label = label, .colour = colour, .width = 4};
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const auto place = static_cast<double>(i + 1);
    for (const double x : {place - 0.45, place + 0.45}) {
      series.x.push_back(x);
      series.y.push_back(1e-3 * stiffness_N_per_m(i));
    }
    series.x.push_back(place + 0.45);
    series.y.push_back(std::nan(""));
  }
  return series;
}

Panel limits_panel(const Json& all, std::size_t hand) {
  Panel panel{.title = "Under a " + all.at("hands").at(hand).at("hand").get<std::string>() + " hand",
              .y_label = "stiffness [N/mm]",
              .y_min = kLowest_N_per_mm,
              .y_max = kHighest_N_per_mm,
              .y_log = true};
  const Json& limits = all.at("limits");
  const auto theory = [&](const char* key) { return [&, key](std::size_t i) { return number(limits.at(i).at(key)); }; };
  panel.series.push_back(theory_lines(limits, "2b/T", "#d0d4d9", theory("passive_N_per_m")));
  panel.series.push_back(theory_lines(limits, "b/(T/2 + 2t)", "#8a929a", theory("delayed_N_per_m")));
  const auto laws = static_cast<double>(all.at("laws").size());
  double place = 0;
  for (const Json& law : all.at("laws")) {
    const std::string name = law.at("law");
    const double aside = laws > 1 ? 0.8 * (place / (laws - 1) - 0.5) : 0;
    place += 1;
    panel.series.push_back(limit_marks(limits, name, colour::of_law(name), aside, [&](std::size_t i) {
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
  // No subtitle: the key needs its room.
  Figure figure{.title = "The stiffest wall that comes to rest [N/mm]: top, all up to 1000; bottom, not even 0.1",
                .x_label = "delay each way; laws from left to right as in the key; ideal device of 30 N s/m"};
  for (const Json& limit : all.at("limits")) {
    const double delay_ms = 1e3 * number(limit.at("delay_s"));
    figure.x_names.push_back(delay_ms > 0 ? text::rounded(delay_ms) + " ms" : "none");
  }
  for (std::size_t hand = 0; hand < all.at("hands").size(); ++hand) figure.panels.push_back(limits_panel(all, hand));
  draw(figure, png);
}

}  // namespace forcebound::lab
