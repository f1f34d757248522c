#include "tests/tools/lab/accuracy/study_text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "forcebound/results/summary_cells.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "tests/tools/lab/accuracy/percent.hpp"
#include "tests/tools/lab/accuracy/recommendation.hpp"

namespace forcebound::lab {
namespace {

using text::rounded;

// A model's part below this share of the age's is negligible: their squares add up, to half a percent more.
constexpr double kLostInAge = 0.1;

// Smaller values are rounding.
constexpr double kLeastShare = 1e-12;

std::string ms(double seconds) { return rounded(seconds * 1e3) + " ms"; }

/// Results of the scenes: one row if all settings have the same scene.
struct SceneRow {
  std::string name;
  const StudiedSetting* setting;
};

std::vector<SceneRow> rows_of_scenes(const StudyResult& result) {
  if (result.same_scene) return {{"(all)", &result.settings.front()}};
  std::vector<SceneRow> rows;
  for (const StudiedSetting& setting : result.settings) rows.push_back({setting.value, &setting});
  return rows;
}

std::string cross(const StudiedSetting& setting) { return setting.trouble.empty() ? "" : "X " + setting.trouble; }

std::string cost_text(const StudyResult& result) {
  text::Table table({{result.key},
                     {"median", "us"},
                     {"p99", "us"},
                     {"max", "us"},
                     {"idle p99", "us"},
                     {"idle max", "us"},
                     {"heap"},
                     {"instructions"}});
  for (const auto& [name, studied] : rows_of_scenes(result)) {
    const StudiedSetting& setting = *studied;
    const auto& [heap, instructions] = setting.per_step;
    table.add({name, rounded(setting.cost.median_us), rounded(setting.cost.p99_us), rounded(setting.cost.max_us),
               rounded(setting.idle.p99_us), rounded(setting.idle.max_us), heap ? rounded(*heap) : "-",
               instructions ? rounded(*instructions) : "-"});
  }
  std::string text = "What a step costs\n" + table.to_text();
  if (!result.settings.front().per_step.instructions) {
    text += "  instructions: not available here (the kernel does not let us count them)\n";
  }
  return text + "  an answer has " + std::to_string(result.answer_bytes) +
         " bytes: " + rounded(static_cast<double>(result.answer_bytes)) + " kB/s to each client at 1 kHz\n";
}

std::string how_states_were_saved(const StudyResult& result) {
  if (result.ticks_between_states == 0 && result.reference_bodies) return "Along the same positions\n";
  if (result.ticks_between_states == 0) return "At the same states (a step has no memory: the same positions)\n";
  const int ticks = result.ticks_between_states;
  return "At the same states (the reference's, " +
         (ticks == 1 ? std::string("before each tick") : "before every " + std::to_string(ticks) + " ticks") +
         "; then all go on from there)\n";
}

std::string at_states_text(const StudyResult& result) {
  const bool bodies = result.ticks_between_states > 0;
  std::vector<text::Table::Column> columns{{result.key},   {"force"},       {"direction", "deg"},
                                           {"p95", "deg"}, {"depth", "mm"}, {"stiffness", "N/m"}};
  if (bodies) columns.push_back({"velocities"});
  columns.push_back({"", "", text::Table::Align::left});
  text::Table table(std::move(columns));
  for (const auto& [name, studied] : rows_of_scenes(result)) {
    const StudiedSetting& setting = *studied;
    const StateError& error = setting.at_states;
    std::vector<text::Table::Cell> row{name,
                                       percent_above(error.force, result.reference_uncertainty),
                                       rounded(error.direction_median_deg),
                                       rounded(error.direction_p95_deg),
                                       rounded(error.penetration_m * 1e3),
                                       rounded(error.displayed_stiffness_N_per_m)};
    if (bodies) row.emplace_back(percent_above(setting.velocity_at_states, result.velocity_uncertainty));
    row.emplace_back(cross(setting));
    table.add(std::move(row));
  }
  return "\n" + how_states_were_saved(result) + table.to_text();
}

std::string free_text(const StudyResult& result) {
  if (!result.reference_bodies) {
    text::Table table({{result.key}, {"work", "mJ"}});
    for (const auto& [name, setting] : rows_of_scenes(result))
      table.add({name, rounded(setting->at_states.work_J * 1e3)});
    return "\nFreely along the same path: work on the device above the reference's\n" + table.to_text();
  }
  text::Table table({{result.key},
                     {"force"},
                     {"work", "mJ"},
                     {"drift", "mJ"},
                     {"most gained", "mJ"},
                     {"deepest", "mm"},
                     {"exhausted"},
                     {"", "", text::Table::Align::left}});
  const auto add = [&](const std::string& name, const std::string& force, const std::string& work,
                       const BodyRecord& bodies, const std::string& trouble) {
    const double exhausted = bodies.ticks > 0 ? static_cast<double>(bodies.exhausted) / bodies.ticks : 0;
    table.add({name, force, work, rounded(1e3 * bodies.drift_J), rounded(1e3 * bodies.gained_J),
               rounded(1e3 * bodies.deepest_m), percent(exhausted), trouble});
  };
  add("the reference", "", "", *result.reference_bodies,
      result.reference_trouble.empty() ? "" : "X " + result.reference_trouble);
  for (const auto& [name, studied] : rows_of_scenes(result)) {
    const StudiedSetting& setting = *studied;
    if (!setting.bodies) continue;
    add(name, percent_above(setting.free_force, result.free_uncertainty), rounded(1e3 * setting.at_states.work_J),
        *setting.bodies, cross(setting));
  }
  std::string text = "\nFreely along the same path (uncertain to " + percent(result.free_uncertainty) +
                     "). Drift: the bodies'\nfinal energy less their initial energy and the work put in\n" +
                     table.to_text();
  if (!result.places_known) {
    text += "  final positions of bodies are not compared: reference and check differ\n";
  }
  return text;
}

std::string remark(const StudiedSetting& setting, std::size_t which, bool is_best) {
  if (!setting.trouble.empty()) return "X";
  return std::string(is_best ? "<- least" : "") + (setting.stays_passive(which) ? "" : " not passive");
}

bool extrapolates(const StudyResult& result, std::size_t which) {
  return std::ranges::any_of(result.settings, [&](const StudiedSetting& setting) {
    return setting.behind[which].error.extrapolation.alone > 0;
  });
}

std::string behind_text(const StudyResult& result, std::size_t which) {
  const double round_trip_s = result.settings.front().behind[which].round_trip_s;
  const bool extrapolated = extrapolates(result, which);
  std::vector<text::Table::Column> columns{{result.key}, {"E_dev"}, {"model"}};
  if (extrapolated) columns.push_back({"extrapolation"});
  for (const char* const name : {"age", "hold", "bounding", "least age"}) columns.push_back({name});
  columns.push_back({"least P", "mJ"});
  columns.push_back({"", "", text::Table::Align::left});
  text::Table table(std::move(columns));
  const auto best = best_setting(result, which, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < result.settings.size(); ++i) {
    const StudiedSetting& setting = result.settings[i];
    const DeviceError& error = setting.behind[which].error;
    // What is not known as a whole has no parts.
    const bool known = is_above(error.total, result.free_uncertainty);
    const auto part = [&](const DeviceError::Part& of) { return known ? percent(of.share) : std::string("-"); };
    std::vector<text::Table::Cell> row{setting.value, percent_above(error.total, result.free_uncertainty),
                                       part(error.model)};
    if (extrapolated) row.emplace_back(part(error.extrapolation));
    for (const DeviceError::Part& of : {error.age, error.hold, error.bounding}) row.emplace_back(part(of));
    row.emplace_back(ms(time::to_seconds(error.least_age)));
    row.emplace_back(results::millijoules(setting.behind[which].passivity_minimum_J));
    row.emplace_back(remark(setting, which, best == i && resolves(result, which)));
    table.add(std::move(row));
  }
  return "\nAt the device, round trip " + ms(round_trip_s) + ": E_dev is the sum of its parts, of which a\n" +
         "negative one offsets others\n" + table.to_text();
}

/// Largest model's error as a share of the age's alone, over the settings that worked; infinite where there is no age
/// or nothing to compare.
double most_model_of_age(const StudyResult& result, std::size_t which) {
  double most = 0;
  int worked = 0;
  for (const StudiedSetting& setting : result.settings) {
    if (!setting.trouble.empty()) continue;
    ++worked;
    const DeviceError& error = setting.behind[which].error;
    most = std::max(
        most, error.age.alone > 0 ? error.model.alone / error.age.alone : std::numeric_limits<double>::infinity());
  }
  return worked < 2 ? std::numeric_limits<double>::infinity() : most;
}

nlohmann::ordered_json optional(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json to_json(const BodyRecord& bodies) {
  return {{"drift_J", bodies.drift_J},     {"gained_J", bodies.gained_J}, {"turned_over_J", bodies.turned_over_J},
          {"deepest_m", bodies.deepest_m}, {"ticks", bodies.ticks},       {"exhausted", bodies.exhausted}};
}

nlohmann::ordered_json to_json(const StepCost& cost) {
  return {{"median", cost.median_us}, {"p99", cost.p99_us}, {"max", cost.max_us}, {"spread", cost.spread_us}};
}

nlohmann::ordered_json to_json(const DeviceError::Part& part) { return {{"share", part.share}, {"alone", part.alone}}; }

}  // namespace

std::string to_text(const StudyResult& result) {
  const std::string head = "Reference: " + result.reference_why + "; uncertain to " +
                           percent(result.reference_uncertainty) + "\nHand: " + result.hand + "\n" +
                           result.assumptions + "Session: " + result.session +
                           (result.fixed.empty() ? "" : "\nWith: " + result.fixed) + "\n\n";
  std::string text = text::wrapped(head, 2) + cost_text(result) + at_states_text(result) + free_text(result);
  for (std::size_t which = 0; which < result.settings.front().behind.size(); ++which)
    text += behind_text(result, which);
  return text;
}

std::string what_does_not_matter(const StudyResult& result) {
  if (result.same_scene || result.settings.size() < 2) return {};
  const std::size_t networks = result.settings.front().behind.size();
  std::vector<std::string> lost;
  double most = 0;
  for (std::size_t which = 0; which < networks; ++which) {
    const double share = most_model_of_age(result, which);
    if (!(share < kLostInAge)) continue;
    lost.push_back(ms(result.settings.front().behind[which].round_trip_s));
    most = std::max(most, share);
  }
  if (lost.empty()) return {};
  const std::string where = lost.size() == networks ? "behind every round trip" : "behind " + text::join(lost);
  return result.key + " is negligible beside the network's age " + where + ": the model's part of every setting is " +
         (most > kLeastShare ? "at most " + percent(most) : "nothing") + " of the age's (the line is " +
         percent(kLostInAge) + ")\n";
}

nlohmann::ordered_json to_json(const StudyResult& result) {
  nlohmann::ordered_json json{{"key", result.key},
                              {"hand", result.hand},
                              {"assumptions", result.assumptions},
                              {"reference",
                               {{"why", result.reference_why},
                                {"order", result.reference_order},
                                {"uncertainty", result.reference_uncertainty},
                                {"velocity_uncertainty", result.velocity_uncertainty},
                                {"free_uncertainty", result.free_uncertainty},
                                {"trouble", result.reference_trouble}}},
                              {"set", result.fixed},
                              {"session", result.session},
                              {"same_scene", result.same_scene},
                              {"extrapolation_per_s", result.extrapolation_per_s},
                              {"answer_bytes", result.answer_bytes},
                              {"ticks_between_states", result.ticks_between_states},
                              {"settings", nlohmann::ordered_json::array()}};
  for (const StudiedSetting& setting : result.settings) {
    nlohmann::ordered_json object{
        {"value", setting.value},
        {"step_us", to_json(setting.cost)},
        {"idle_us", to_json(setting.idle)},
        {"heap_operations", optional(setting.per_step.heap_operations)},
        {"instructions", optional(setting.per_step.instructions)},
        {"force_error", setting.at_states.force},
        {"velocity_error", setting.velocity_at_states},
        {"free_force_error", setting.free_force},
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
                                  {"extrapolation", to_json(behind.error.extrapolation)},
                                  {"age", to_json(behind.error.age)},
                                  {"hold", to_json(behind.error.hold)},
                                  {"bounding", to_json(behind.error.bounding)},
                                  {"least_age_s", time::to_seconds(behind.error.least_age)},
                                  {"motions_missed", behind.turns_missed},
                                  {"passivity_minimum_J", behind.passivity_minimum_J}});
    }
    if (setting.bodies) object["bodies"] = to_json(*setting.bodies);
    json["settings"].push_back(std::move(object));
  }
  return json;
}

}  // namespace forcebound::lab
