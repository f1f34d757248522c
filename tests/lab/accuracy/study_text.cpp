#include "tests/lab/accuracy/study_text.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "forcebound/text/numbers.hpp"
#include "tests/lab/figure.hpp"

namespace forcebound::lab {
namespace {

using text::rounded;

// Settings whose errors differ by less than this share of the least do not matter to the hand.
constexpr double kAlike = 0.05;

std::string percent(double share) { return rounded(100 * share) + " %"; }

std::string percent_above(double share, double uncertainty) {
  return share < 3 * uncertainty ? "<= " + percent(3 * uncertainty) : percent(share);
}

std::string ms(double seconds) { return rounded(seconds * 1e3) + " ms"; }

template <class... Values>
std::string line(const char* format, const Values&... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return std::string(text) + "\n";
}

std::string at_states_text(const StudyResult& result) {
  std::string text =
      "At the same states\n" + line("  %-18s %10s %10s %10s %12s %12s %10s %12s %11s  %s", result.key.c_str(), "median",
                                    "p99", "idle p99", "force", "direction", "p95", "stiffness", "work", "");
  for (const StudiedSetting& setting : result.settings) {
    const StateError& error = setting.at_states;
    text += line("  %-18s %7s us %7s us %7s us %12s %8s deg %6s deg %8s N/m %8s mJ  %s", setting.value.c_str(),
                 rounded(setting.cost.median_us).c_str(), rounded(setting.cost.p99_us).c_str(),
                 rounded(setting.idle.p99_us).c_str(), percent_above(error.force, result.reference_uncertainty).c_str(),
                 rounded(error.direction_median_deg).c_str(), rounded(error.direction_p95_deg).c_str(),
                 rounded(error.displayed_stiffness_N_per_m).c_str(), rounded(error.work_J * 1e3).c_str(),
                 setting.trouble.empty() ? "" : ("X " + setting.trouble).c_str());
  }
  return text;
}

std::string behind_text(const StudyResult& result, std::size_t which) {
  const double round_trip_s = result.settings.front().behind[which].round_trip_s;
  std::string text = "\nAt the device, round trip " + ms(round_trip_s) + "\n" +
                     line("  %-18s %10s = %9s + %9s + %9s + %9s %12s %10s", result.key.c_str(), "E_dev", "model", "age",
                          "hold", "bounding", "least age", "P min");
  const auto best = best_setting(result, which, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < result.settings.size(); ++i) {
    const StudiedSetting& setting = result.settings[i];
    const DeviceError& error = setting.behind[which].error;
    text +=
        line("  %-18s %10s = %9s + %9s + %9s + %9s %9s %8s J%s", setting.value.c_str(),
             percent_above(error.total, result.reference_uncertainty).c_str(), percent(error.model.share).c_str(),
             percent(error.age.share).c_str(), percent(error.hold.share).c_str(), percent(error.bounding.share).c_str(),
             ms(time::to_seconds(error.least_age)).c_str(), rounded(setting.behind[which].passivity_minimum_J).c_str(),
             !setting.trouble.empty() ? "  X" : (best == i ? "  <- best" : ""));
  }
  return text;
}

nlohmann::ordered_json to_json(const DeviceError::Part& part) { return {{"share", part.share}, {"alone", part.alone}}; }

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

std::string to_text(const StudyResult& result) {
  std::string text = "Reference: " + result.reference_why + "; uncertain to " + percent(result.reference_uncertainty) +
                     "\nHand: " + result.hand + "\n\n" + at_states_text(result);
  for (std::size_t which = 0; which < result.settings.front().behind.size(); ++which)
    text += behind_text(result, which);
  return text;
}

std::string recommendation(const StudyResult& result, double budget_us) {
  std::string text;
  for (std::size_t which = 0; which < result.settings.front().behind.size(); ++which) {
    const std::string network = "behind " + ms(result.settings.front().behind[which].round_trip_s) + ": ";
    const auto best = best_setting(result, which, budget_us);
    if (!best) {
      text += network + "nothing that worked takes at most " + rounded(budget_us) + " us\n";
      continue;
    }
    const auto error = [&](std::size_t i) { return result.settings[i].behind[which].error; };
    double worst = 0;
    for (std::size_t i = 0; i < result.settings.size(); ++i) {
      if (result.settings[i].trouble.empty()) worst = std::max(worst, error(i).total);
    }
    const DeviceError least = error(*best);
    text += network + result.key + " = " + result.settings[*best].value + ", E_dev " + percent(least.total) + ", " +
            rounded(result.settings[*best].cost.median_us) + " us a step";
    if (worst <= (1 + kAlike) * least.total) {
      text += "; but " + result.key + " hardly matters here: the worst setting has " + percent(worst) + ", of which " +
              percent(least.age.share + least.hold.share) + " are the age of forces";
    }
    text += "\n";
  }
  return text;
}

nlohmann::ordered_json to_json(const StudyResult& result) {
  nlohmann::ordered_json json{{"key", result.key},
                              {"hand", result.hand},
                              {"reference",
                               {{"why", result.reference_why},
                                {"order", result.reference_order},
                                {"uncertainty", result.reference_uncertainty}}},
                              {"settings", nlohmann::ordered_json::array()}};
  for (const StudiedSetting& setting : result.settings) {
    nlohmann::ordered_json object{
        {"value", setting.value},
        {"step_us", {{"median", setting.cost.median_us}, {"p99", setting.cost.p99_us}, {"max", setting.cost.max_us}}},
        {"idle_us", {{"median", setting.idle.median_us}, {"p99", setting.idle.p99_us}, {"max", setting.idle.max_us}}},
        {"force_error", setting.at_states.force},
        {"direction_deg",
         {{"median", setting.at_states.direction_median_deg}, {"p95", setting.at_states.direction_p95_deg}}},
        {"penetration_m", setting.at_states.penetration_m},
        {"displayed_stiffness_N_per_m", setting.at_states.displayed_stiffness_N_per_m},
        {"work_J", setting.at_states.work_J},
        {"trouble", setting.trouble},
        {"behind", nlohmann::ordered_json::array()}};
    for (const StudiedSetting::Behind& behind : setting.behind) {
      object["behind"].push_back({{"round_trip_s", behind.round_trip_s},
                                  {"error", behind.error.total},
                                  {"model", to_json(behind.error.model)},
                                  {"age", to_json(behind.error.age)},
                                  {"hold", to_json(behind.error.hold)},
                                  {"bounding", to_json(behind.error.bounding)},
                                  {"least_age_s", time::to_seconds(behind.error.least_age)},
                                  {"motions_missed", behind.turns_missed},
                                  {"passivity_minimum_J", behind.passivity_minimum_J}});
    }
    json["settings"].push_back(std::move(object));
  }
  return json;
}

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
