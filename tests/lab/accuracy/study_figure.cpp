#include <cmath>
#include <limits>

#include "forcebound/text/numbers.hpp"
#include "tests/lab/accuracy/study_text.hpp"
#include "tests/lab/figure.hpp"

namespace forcebound::lab {
namespace {

std::string ms(double seconds) { return text::rounded(seconds * 1e3) + " ms"; }

Series curve_of(const StudyResult& result, std::size_t which, std::size_t colour_index) {
  Series curve{.label = ms(result.settings.front().behind[which].round_trip_s),
               .colour = colour::kAxes[colour_index % 6],
               .mark = Series::Mark::dot};
  for (const StudiedSetting& setting : result.settings) {
    curve.x.push_back(setting.cost.median_us);
    curve.y.push_back(setting.trouble.empty() ? 100 * setting.behind[which].error.total : std::nan(""));
  }
  return curve;
}

Panel error_panel(const StudyResult& result) {
  Panel panel{
      .title = "Error at the device; ring: the best setting behind that network; cross: failed or not converged",
      .y_label = "E_dev [%]",
      .y_log = true};
  for (std::size_t which = 0; which < result.settings.front().behind.size(); ++which) {
    panel.series.push_back(curve_of(result, which, which));
  }
  for (std::size_t which = 0; which < result.settings.front().behind.size(); ++which) {
    const char* const colour = colour::kAxes[which % 6];
    Series failed{.label = "", .colour = colour, .mark = Series::Mark::cross};
    for (const StudiedSetting& setting : result.settings) {
      if (setting.trouble.empty()) continue;
      failed.x.push_back(setting.cost.median_us);
      failed.y.push_back(100 * setting.behind[which].error.total);
    }
    if (!failed.x.empty()) panel.series.push_back(failed);
    const auto best = best_setting(result, which, std::numeric_limits<double>::infinity());
    if (!best) continue;
    const StudiedSetting& setting = result.settings[*best];
    panel.series.push_back({.label = "",
                            .x = {setting.cost.median_us},
                            .y = {100 * setting.behind[which].error.total},
                            .colour = colour,
                            .mark = Series::Mark::ring});
  }
  return panel;
}

Panel parts_panel(const StudyResult& result, std::size_t which) {
  Panel panel{.title = "What it comes from behind " + ms(result.settings.front().behind[which].round_trip_s) +
                       ": shares that add up to E_dev",
              .y_label = "share [%]"};
  const auto add = [&](const char* label, const char* colour, auto share) {
    Series series{.label = label, .colour = colour, .mark = Series::Mark::dot};
    for (const StudiedSetting& setting : result.settings) {
      series.x.push_back(setting.cost.median_us);
      series.y.push_back(100 * share(setting.behind[which].error));
    }
    panel.series.push_back(std::move(series));
  };
  add("model", colour::kApplied, [](const DeviceError& error) { return error.model.share; });
  add("age", colour::kNetwork, [](const DeviceError& error) { return error.age.share; });
  add("hold", colour::kRoundTrip, [](const DeviceError& error) { return error.hold.share; });
  add("bounding", colour::kLedger, [](const DeviceError& error) { return error.bounding.share; });
  return panel;
}

}  // namespace

void draw(const StudyResult& result, const std::string& title, const std::filesystem::path& png) {
  Figure figure{.title = title,
                .subtitle = result.key + ", " + result.hand.substr(0, result.hand.find(',')),
                .x_label = "time of a step, median [us]"};
  figure.x_log = true;
  figure.panels.push_back(error_panel(result));
  const std::size_t networks = result.settings.front().behind.size();
  figure.panels.push_back(parts_panel(result, 0));
  if (networks > 1) figure.panels.push_back(parts_panel(result, networks - 1));
  draw(figure, png);
}

}  // namespace forcebound::lab
