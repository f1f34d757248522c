#include "tests/tools/lab/rendering/rendering_results.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "forcebound/text/terminal.hpp"
#include "forcebound/time/percentile.hpp"
#include "tests/tools/lab/comparison/trial.hpp"
#include "tests/tools/lab/figures/figure_scripts.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr std::array<std::string_view, 3> kConditionKinds{"delays", "recorded", "blackouts"};
constexpr double kNoWorse = 0.02;  // E_dev of local rendering over that of remote, at most

/// Of a run, beside that of the same seed without a network.
struct RenderingQuantity {
  const char* name;
  double (*of)(const RenderingFigures& run, const RenderingFigures& without_network);
};

constexpr std::array kRenderingQuantities{
    RenderingQuantity{"stiffness", displayed_over},
    RenderingQuantity{"stiffness_N_per_m", [](const auto& run, const auto&) { return run.stiffness_N_per_m; }},
    RenderingQuantity{"error", [](const auto& run, const auto&) { return run.error; }},
    RenderingQuantity{"error_beyond", [](const auto& run, const auto& without) { return run.error - without.error; }},
    RenderingQuantity{"true_share", [](const auto& run, const auto&) { return run.true_share; }},
    RenderingQuantity{"change_N_per_ms", [](const auto& run, const auto&) { return run.change_N_per_ms; }},
    RenderingQuantity{"late_ticks",
                      [](const auto& run, const auto& without) { return run.felt_tick - without.felt_tick; }},
    RenderingQuantity{"ready_s", [](const auto& run, const auto&) { return run.ready_s; }},
    RenderingQuantity{"start_B_per_s", [](const auto& run, const auto&) { return run.start_B_per_s; }},
    RenderingQuantity{"steady_B_per_s", [](const auto& run, const auto&) { return run.steady_B_per_s; }},
    RenderingQuantity{"scene_bytes", [](const auto& run, const auto&) { return run.scene_bytes; }},
    RenderingQuantity{"motions_per_s", [](const auto& run, const auto&) { return run.motions_per_s; }},
    RenderingQuantity{"at_client", [](const auto& run, const auto&) { return run.at_client; }},
    RenderingQuantity{"minimum_J", [](const auto& run, const auto&) { return run.minimum_J; }}};

/// Which of the seeds' values: their places in a study.
enum class OfSeeds : std::uint8_t { median, least, most };

/// Six digits: more says nothing.
double in_short(double value) { return text::finite_number(text::rounded(value, 6)).value_or(value); }

/// Of the same quantity of all seeds. Not a number if one is not.
Json over_seeds(std::vector<double> values) {
  const bool all_known = std::ranges::none_of(values, [](double value) { return std::isnan(value); });
  if (!all_known || values.empty()) values = {std::nan("")};
  const double median = time::percentile_of(values, 0.5);
  const auto [least, most] = std::ranges::minmax(values);
  return Json::array({in_short(median), in_short(least), in_short(most)});
}

Json quantities_of(const std::vector<RenderingFigures>& runs, const std::vector<RenderingFigures>& without_network) {
  Json all = Json::object();
  for (const RenderingQuantity& quantity : kRenderingQuantities) {
    std::vector<double> values(runs.size());
    std::ranges::transform(runs, without_network, values.begin(), quantity.of);
    all[quantity.name] = over_seeds(std::move(values));
  }
  return all;
}

/// Not a number where a file has null, or was written before there was that quantity.
double figure_of(const Json& row, const char* rendering, const char* quantity, OfSeeds which = OfSeeds::median) {
  const Json& figures = row.at(rendering);
  if (!figures.contains(quantity)) return std::nan("");
  const Json& value = figures.at(quantity).at(static_cast<std::size_t>(which));
  return value.is_number() ? value.get<double>() : std::nan("");
}

double seeds_apart(const Json& row, const char* quantity) {
  return figure_of(row, "local", quantity, OfSeeds::most) - figure_of(row, "local", quantity, OfSeeds::least);
}

// What is not a number stays: it reaches no goal.
void keep_least(double& least, double value) { least = std::isnan(least) || least < value ? least : value; }
void keep_most(double& most, double value) { most = std::isnan(most) || most > value ? most : value; }

std::string or_never(double value, int decimals) {
  return std::isfinite(value) ? text::fixed(value, decimals) : "never";
}

/// The worst of some rows.
struct WorstOfRows {
  double remote = kNever;     ///< displayed stiffness over that without a network
  double stiffness = kNever;  ///< the same, of local rendering, as all that follows
  double remote_error = -kNever;
  double error = -kNever;
  double error_beyond = -kNever;
  double error_over_remote = -kNever;  ///< local less remote
  double error_without = -kNever;
  double felt_apart_ticks = -kNever;  ///< from the contact without a network, late or early: the most of all seeds
  double ready_s = -kNever;
  double start_B_per_s = -kNever;
  double steady_B_per_s = -kNever;
  double at_client = kNever;
  double minimum_J = kNever;  ///< the least of all seeds, remote too

  void add(const Json& row) {
    keep_least(remote, figure_of(row, "remote", "stiffness"));
    keep_least(stiffness, figure_of(row, "local", "stiffness"));
    keep_most(remote_error, figure_of(row, "remote", "error"));
    keep_most(error, figure_of(row, "local", "error"));
    keep_most(error_beyond, figure_of(row, "local", "error_beyond"));
    keep_most(error_over_remote, figure_of(row, "local", "error") - figure_of(row, "remote", "error"));
    keep_most(error_without, figure_of(row, "without_network", "error"));
    keep_most(felt_apart_ticks, std::abs(figure_of(row, "local", "late_ticks", OfSeeds::least)));
    keep_most(felt_apart_ticks, std::abs(figure_of(row, "local", "late_ticks", OfSeeds::most)));
    keep_most(ready_s, figure_of(row, "local", "ready_s"));
    keep_most(start_B_per_s, figure_of(row, "local", "start_B_per_s"));
    keep_most(steady_B_per_s, figure_of(row, "local", "steady_B_per_s"));
    keep_least(at_client, figure_of(row, "local", "at_client"));
    keep_least(minimum_J, figure_of(row, "local", "minimum_J", OfSeeds::least));
    keep_least(minimum_J, figure_of(row, "remote", "minimum_J", OfSeeds::least));
  }
};

/// All rows of a class of scenes.
struct RenderingClass {
  std::string name;
  RenderingGoal goal{};
  std::array<WorstOfRows, kConditionKinds.size()> of_kind{};
  WorstOfRows all{};
};

std::vector<RenderingClass> classes_of(const Json& study) {
  std::vector<RenderingClass> classes;
  for (const Json& row : study.at("rows")) {
    const std::string name = row.at("class");
    if (classes.empty() || classes.back().name != name) {
      const Json& goal = row.at("goal");
      classes.push_back({.name = name, .goal = {.stiffness = goal.at("stiffness").get<double>(), .error = kNever}});
      if (goal.at("error").is_number()) classes.back().goal.error = goal.at("error").get<double>();
    }
    classes.back().all.add(row);
    const std::string kind_name = row.at("kind");
    const auto* const kind = std::ranges::find(kConditionKinds, std::string_view(kind_name));
    if (kind != kConditionKinds.end()) {
      classes.back().of_kind.at(static_cast<std::size_t>(kind - kConditionKinds.begin())).add(row);
    }
  }
  return classes;
}

text::Table goals_table(const Json& study) {
  text::Table table({{"class"},
                     {"wanted"},
                     {"behind delays"},
                     {"recorded"},
                     {"blackouts"},
                     {"E_dev beyond"},
                     {"over remote"},
                     {"felt apart", "ticks"},
                     {"least P", "nJ"},
                     {"goal"},
                     {"at client", "%"},
                     {"ready", "s"},
                     {"start", "kB/s"},
                     {"steady", "kB/s"}});
  for (const RenderingClass& one : classes_of(study)) {
    bool reached = true;
    const auto judged = [&](const std::string& words, bool good) -> text::Table::Cell {
      reached = reached && good;
      return {words, good ? text::Table::Mark::none : text::Table::Mark::alarm};
    };
    std::vector<text::Table::Cell> row{one.name, ">= " + text::to_text(one.goal.stiffness)};
    for (const WorstOfRows& worst : one.of_kind) {
      const bool was_run = worst.stiffness != kNever;
      row.push_back(judged(text::fixed(worst.stiffness, 3), !was_run || worst.stiffness >= one.goal.stiffness));
    }
    const WorstOfRows& all = one.all;
    row.push_back(
        judged(text::fixed(all.error_beyond, 3), one.goal.error == kNever || all.error_beyond <= one.goal.error));
    row.push_back(judged(text::fixed(all.error_over_remote, 3), all.error_over_remote <= kNoWorse));
    row.push_back(judged(or_never(all.felt_apart_ticks, 0), all.felt_apart_ticks <= 1));
    row.push_back(judged(text::fixed(1e9 * all.minimum_J, 2), all.minimum_J >= kPassive_J));
    row.push_back(judged(reached ? "reached" : "missed", reached));
    row.emplace_back(text::fixed(100 * all.at_client, 1));
    row.emplace_back(or_never(all.ready_s, 2));
    row.emplace_back(text::fixed(1e-3 * all.start_B_per_s, 1));
    row.emplace_back(text::fixed(1e-3 * all.steady_B_per_s, 1));
    table.add(std::move(row));
  }
  return table;
}

text::Table rows_table(const Json& study) {
  text::Table table({{"scene and network"},
                     {"K alone", "N/mm"},
                     {"E alone"},
                     {"remote"},
                     {"local"},
                     {"spread"},
                     {"E remote"},
                     {"E local"},
                     {"spread"},
                     {"share", "remote"},
                     {"share", "local"},
                     {"change", "N/ms"},
                     {"late", "ticks"},
                     {"ready", "s"},
                     {"start", "kB/s"},
                     {"steady", "kB/s"},
                     {"motions", "1/s"},
                     {"at client", "%"},
                     {"least P", "nJ"}});
  std::string scene;
  for (const Json& row : study.at("rows")) {
    const std::string name = row.at("scene");
    if (name != scene) table.add_heading(name);
    scene = name;
    const double least_P_J = std::min(figure_of(row, "local", "minimum_J", OfSeeds::least),
                                      figure_of(row, "remote", "minimum_J", OfSeeds::least));
    table.add({row.at("condition").get<std::string>(),
               text::fixed(1e-3 * figure_of(row, "without_network", "stiffness_N_per_m"), 3),
               text::fixed(figure_of(row, "without_network", "error"), 3),
               text::fixed(figure_of(row, "remote", "stiffness"), 3),
               text::fixed(figure_of(row, "local", "stiffness"), 3),
               text::fixed(seeds_apart(row, "stiffness"), 3),
               text::fixed(figure_of(row, "remote", "error"), 3),
               text::fixed(figure_of(row, "local", "error"), 3),
               text::fixed(seeds_apart(row, "error"), 3),
               text::fixed(figure_of(row, "remote", "true_share"), 2),
               text::fixed(figure_of(row, "local", "true_share"), 2),
               text::fixed(figure_of(row, "local", "change_N_per_ms"), 2),
               or_never(figure_of(row, "local", "late_ticks"), 0),
               or_never(figure_of(row, "local", "ready_s"), 2),
               text::fixed(1e-3 * figure_of(row, "local", "start_B_per_s"), 1),
               text::fixed(1e-3 * figure_of(row, "local", "steady_B_per_s"), 1),
               text::fixed(figure_of(row, "local", "motions_per_s"), 0),
               text::fixed(100 * figure_of(row, "local", "at_client"), 1),
               {text::fixed(1e9 * least_P_J, 2),
                least_P_J >= kPassive_J ? text::Table::Mark::none : text::Table::Mark::alarm}});
  }
  return table;
}

/// One figure of each scene, by its worst seed where `of_seeds` says so: remote beside local behind each network of a
/// kind.
struct SideBySide {
  const char* head;
  const char* quantity;
  double unit;
  int decimals;
  OfSeeds of_seeds = OfSeeds::median;
};

constexpr std::array kSideBySide{
    SideBySide{"E_dev", "error", 1, 3},
    SideBySide{"Share of the true force that is applied", "true_share", 1, 2},
    SideBySide{"Largest change of the force applied [N/ms]", "change_N_per_ms", 1, 2},
    SideBySide{"Least P of all seeds [nJ]", "minimum_J", 1e9, 2, OfSeeds::least},
};

/// Empty if nothing of that kind was run.
std::string side_by_side(const Json& study, std::string_view kind, const SideBySide& shown) {
  std::vector<text::Table::Column> columns{{"scene"}};
  std::vector<std::vector<text::Table::Cell>> lines;
  std::string first;
  for (const Json& row : study.at("rows")) {
    const std::string scene = row.at("scene");
    if (row.at("kind") != kind) continue;
    if (first.empty()) first = scene;
    if (lines.empty() || lines.back().front().text != scene) lines.push_back({scene});
    for (const char* const rendering : {"remote", "local"}) {
      if (scene == first) columns.push_back({rendering, row.at("condition").get<std::string>()});
      const double figure = shown.unit * figure_of(row, rendering, shown.quantity, shown.of_seeds);
      lines.back().emplace_back(text::fixed(figure, shown.decimals));
    }
  }
  if (lines.empty()) return {};
  text::Table table(std::move(columns));
  for (std::vector<text::Table::Cell>& line : lines) table.add(std::move(line));
  constexpr std::size_t kWide = 100;
  return std::string(shown.head) + ", " + std::string(kind) + "\n\n" + table.to_text(text::Colour::none, kWide) + "\n";
}

std::string how_it_was_taken(const Json& study) {
  const auto seeds = study.at("settings").at("seeds").get<std::uint64_t>();
  return "Law " + study.at("settings").at("law").get<std::string>() + ", medians over " + text::counted(seeds, "seed") +
         ", virtual time.";
}

}  // namespace

Json rendering_json(const RenderingStudySettings& settings, const std::vector<RenderingRow>& rows) {
  Json all = Json::array();
  for (const RenderingRow& row : rows) {
    all.push_back({{"scene", row.task},
                   {"class", row.group},
                   {"goal", {{"stiffness", row.goal.stiffness}, {"error", row.goal.error}}},
                   {"condition", row.condition},
                   {"kind", row.kind},
                   {"without_network", quantities_of(row.without_network, row.without_network)},
                   {"remote", quantities_of(row.remote, row.without_network)},
                   {"local", quantities_of(row.local, row.without_network)}});
  }
  return {{"settings", {{"law", settings.law}, {"seeds", settings.seeds}}}, {"rows", std::move(all)}};
}

std::string rendering_file(const Json& study) {
  std::string file = "{\"settings\":" + study.at("settings").dump() + ",\"rows\":[";
  const char* before = "\n";
  for (const Json& row : study.at("rows")) {
    file.append(before).append(row.dump());
    before = ",\n";
  }
  return file + "\n]}\n";
}

std::string rendering_text(const Json& study) {
  return how_it_was_taken(study) + "\n\n" + rows_table(study).to_text() +
         "\n"
         "  K alone    displayed without a network: least squares of the force out of\n"
         "             the surface over the true depth; -: nothing is pressed in\n"
         "  E_dev, E   RMS of applied less true force over RMS of the true force, since\n"
         "             the first contact; alone: without a network\n"
         "  remote, local  stiffness over K alone; where that is -, the share of the true\n"
         "             force that is applied, over that without a network\n"
         "  spread     of the figure to its left: most less least of the seeds\n"
         "  share      dot of applied and true force over the true one's square\n"
         "  change     the largest of the force applied, local rendering, as all that\n"
         "             follows\n"
         "  late       the first force behind that without a network\n"
         "  ready      from the start to the first tick rendered at the client\n"
         "  start      payloads sent, both ways, in the first second; steady: in the end\n"
         "  at client  share of the ticks since the first contact\n"
         "  least P    of all seeds and both renderings\n"
         "\n"
         "Each class beside its goal, by its worst scene:\n\n" +
         goals_table(study).to_text();
}

std::string rendering_side_by_side(const Json& study) {
  std::string told = how_it_was_taken(study) + " Remote at 0 ms is without a network.\n\n";
  for (const SideBySide& shown : kSideBySide)
    for (const std::string_view kind : kConditionKinds) told += side_by_side(study, kind, shown);
  return told;
}

std::string rendering_markdown(const Json& study) {
  return how_it_was_taken(study) + " Bold misses its goal.\n\n" + goals_table(study).to_markdown();
}

std::string rendering_csv(const Json& study) {
  text::Table table(
      {{"class"}, {"scene"}, {"condition"}, {"rendering"}, {"quantity"}, {"median"}, {"least"}, {"most"}});
  for (const Json& row : study.at("rows")) {
    for (const char* const rendering : {"without_network", "remote", "local"}) {
      for (const RenderingQuantity& quantity : kRenderingQuantities) {
        const auto number_of = [&](OfSeeds which) {
          return results::figure_number(figure_of(row, rendering, quantity.name, which));
        };
        table.add({row.at("class").get<std::string>(), row.at("scene").get<std::string>(),
                   row.at("condition").get<std::string>(), rendering, quantity.name, number_of(OfSeeds::median),
                   number_of(OfSeeds::least), number_of(OfSeeds::most)});
      }
    }
  }
  return table.to_csv();
}

results::Figure rendering_figure(const Json& study) {
  text::Table table({{"class"},
                     {"condition"},
                     {"remote_stiffness"},
                     {"local_stiffness"},
                     {"wanted_stiffness"},
                     {"remote_error"},
                     {"local_error"},
                     {"without_error"}});
  // The rows of a class stand together, and its networks recur for each of its scenes.
  std::vector<std::string> conditions;
  for (const Json& row : study.at("rows")) {
    const std::string condition = row.at("condition");
    if (std::ranges::count(conditions, condition) == 0) conditions.push_back(condition);
  }
  for (const RenderingClass& one : classes_of(study)) {
    for (const std::string& condition : conditions) {
      WorstOfRows worst;
      for (const Json& row : study.at("rows"))
        if (row.at("class") == one.name && row.at("condition") == condition) worst.add(row);
      table.add({one.name, condition, results::figure_number(worst.remote), results::figure_number(worst.stiffness),
                 results::figure_number(one.goal.stiffness), results::figure_number(worst.remote_error),
                 results::figure_number(worst.error), results::figure_number(worst.error_without)});
    }
  }
  return {.script = text::text_of(figure_scripts(), "rendering"),
          .csv = table.to_csv(),
          .subtitle = how_it_was_taken(study)};
}

}  // namespace forcebound::lab
