#include <algorithm>
#include <cmath>
#include <limits>

#include "forcebound/text/numbers.hpp"
#include "tests/tools/lab/accuracy/study_text.hpp"
#include "tests/tools/lab/figure.hpp"

namespace forcebound::lab {
namespace {

// Smallest share drawn: zero has no place on a logarithmic axis.
constexpr double kLeastShareDrawn = 1e-6;

std::string figure_ms(double seconds) { return text::rounded(seconds * 1e3) + " ms"; }

/// X axis: the cost of a scene's settings; settings of a session side by side.
double place_of(const StudyResult& result, std::size_t which) {
  return result.same_scene ? static_cast<double>(which + 1) : result.settings[which].cost.median_us;
}

/// One figure for each setting: a curve of those that worked, and crosses of the others. Settings of a session have
/// nothing in between, so no curve either.
template <class Share>
void add_percents(Panel& panel, const StudyResult& result, const std::string& label, const char* colour, Share share) {
  Series worked{.label = label, .colour = colour, .mark = Series::Mark::dot};
  Series failed{.label = "", .colour = colour, .mark = Series::Mark::cross};
  const auto add = [&](double x, double worked_percent, double failed_percent) {
    worked.x.push_back(x);
    worked.y.push_back(worked_percent);
    failed.x.push_back(x);
    failed.y.push_back(failed_percent);
  };
  for (std::size_t i = 0; i < result.settings.size(); ++i) {
    const bool has_worked = result.settings[i].trouble.empty();
    const double percent = 100 * share(result.settings[i]);
    const double x = place_of(result, i);
    add(x, has_worked ? percent : std::nan(""), has_worked ? std::nan("") : percent);
    if (result.same_scene) add(x, std::nan(""), std::nan(""));
  }
  panel.series.push_back(std::move(worked));
  panel.series.push_back(std::move(failed));
}

/// The settings' values, once, above their points; those of a session stand along the axis.
void add_names(Panel& panel, const StudyResult& result) {
  if (result.same_scene) return;
  for (std::size_t i = 0; i < result.settings.size(); ++i) {
    const bool has_worked = result.settings[i].trouble.empty();
    Series& of = panel.series[has_worked ? 0 : 1];
    of.names.resize(result.settings.size());
    of.names[i] = result.settings[i].value;
  }
}

Panel error_panel(const StudyResult& result) {
  Panel panel{.title = "Error at the device; ring: the best setting behind that network; cross: failed",
              .y_label = "E_dev [%]",
              .y_log = true};
  const std::size_t networks = result.settings.front().behind.size();
  for (std::size_t which = 0; which < networks; ++which) {
    add_percents(panel, result, figure_ms(result.settings.front().behind[which].round_trip_s), colour::kAxes[which % 6],
                 [which](const StudiedSetting& setting) { return setting.behind[which].error.total; });
  }
  add_names(panel, result);
  for (std::size_t which = 0; which < networks; ++which) {
    const auto best = best_setting(result, which, std::numeric_limits<double>::infinity());
    if (!best) continue;
    const StudiedSetting& setting = result.settings[*best];
    panel.series.push_back({.label = "",
                            .x = {place_of(result, *best)},
                            .y = {100 * setting.behind[which].error.total},
                            .colour = colour::kAxes[which % 6],
                            .mark = Series::Mark::ring});
  }
  return panel;
}

Panel states_panel(const StudyResult& result) {
  Panel panel{.title = "At the same states, not below three times the reference's uncertainty",
              .y_label = "error [%]",
              .y_log = true};
  const double least = std::max(3 * result.reference_uncertainty, kLeastShareDrawn);
  add_percents(panel, result, "force", colour::kApplied,
               [least](const StudiedSetting& setting) { return std::max(least, setting.at_states.force); });
  if (result.ticks_between_states > 0) {
    const double least_velocity = std::max(3 * result.velocity_uncertainty, kLeastShareDrawn);
    add_percents(panel, result, "velocities", colour::kLedger,
                 [=](const StudiedSetting& setting) { return std::max(least_velocity, setting.velocity_at_states); });
  }
  return panel;
}

Panel parts_panel(const StudyResult& result, std::size_t which) {
  Panel panel{.title = "Parts of the error behind " + figure_ms(result.settings.front().behind[which].round_trip_s) +
                       ": shares that add up to E_dev",
              .y_label = "share [%]"};
  const auto add = [&](const char* label, const char* colour, DeviceError::Part DeviceError::*part) {
    add_percents(panel, result, label, colour,
                 [=](const StudiedSetting& setting) { return (setting.behind[which].error.*part).share; });
  };
  add("model", colour::kApplied, &DeviceError::model);
  add("age", colour::kNetwork, &DeviceError::age);
  add("hold", colour::kRoundTrip, &DeviceError::hold);
  add("bounding", colour::kLedger, &DeviceError::bounding);
  return panel;
}

}  // namespace

void draw(const StudyResult& result, const std::string& title, const std::filesystem::path& png) {
  Figure figure{.title = title,
                .subtitle = result.key + (result.fixed.empty() ? "" : " with " + result.fixed) + ", " +
                            result.hand.substr(0, result.hand.find(',')) +
                            (result.reference_trouble.empty() ? "" : "; the reference itself failed"),
                .x_label = result.same_scene ? result.key : "time of a step, median [us]"};
  figure.x_log = !result.same_scene;
  for (const StudiedSetting& setting : result.settings) {
    if (result.same_scene) figure.x_names.push_back(setting.value);
  }
  figure.panels.push_back(error_panel(result));
  if (!result.same_scene) figure.panels.push_back(states_panel(result));
  const std::size_t networks = result.settings.front().behind.size();
  figure.panels.push_back(parts_panel(result, 0));
  if (networks > 1) figure.panels.push_back(parts_panel(result, networks - 1));
  draw(figure, png);
}

}  // namespace forcebound::lab
