#include <unistd.h>
#include <CLI/CLI.hpp>

#include <iostream>
#include <memory>
#include <vector>

#include "forcebound/control/law_registry.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/output_options.hpp"
#include "forcebound/program/progress.hpp"
#include "forcebound/results/draw.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/experiment_run.hpp"
#include "tests/tools/lab/figures/figure_scripts.hpp"
#include "tests/tools/lab/passivity.hpp"

namespace forcebound::lab {
namespace {

struct PassivityOptions {
  PassivitySettings settings;
  std::string csv;
  std::string figure;
  std::vector<std::string> formats;
};

/// The cost of the guarantee: the paper's walls with each law.
std::string costs() {
  const auto walls = experiments("wall");
  std::vector<text::Table::Column> columns{{"law"}};
  for (const Experiment& wall : walls) {
    columns.push_back({text::rounded(wall.stiffness_N_per_m * 1e-3) + " N/mm", "N/mm"});
    columns.push_back({"rings", "s"});
  }
  text::Table table(std::move(columns));
  for (const std::string& law : control::force_bounding_laws().names()) {
    std::vector<text::Table::Cell> row{law};
    for (const Experiment& wall : walls) {
      const ExperimentRun run = run_experiment(wall, law, nullptr);
      row.emplace_back(text::fixed(run.displayed_stiffness_N_per_m() * 1e-3, 1));
      row.emplace_back(run.ringing_s ? text::fixed(*run.ringing_s, 2) : "-");
    }
    table.add(std::move(row));
  }
  return "\nIts cost: displayed stiffness at rest and ringing on the paper's walls (30 N\n"
         "s/m, encoder 15 um); -: never at rest.\n\n" +
         table.to_text();
}

std::vector<PassivityResult> run_all(const PassivitySettings& settings) {
  const auto conditions = passivity_conditions();
  program::Progress progress;
  std::vector<PassivityResult> results;
  for (const PassivityCondition& condition : conditions) {
    progress.report(static_cast<double>(results.size()) / static_cast<double>(conditions.size()),
                    std::to_string(results.size()) + " of " + std::to_string(conditions.size()) + " conditions");
    results.push_back(worst_passivity(condition, settings));
  }
  return results;
}

void run(const PassivityOptions& options) {
  results::prepare({.files = {options.csv}, .figures = {options.figure}, .formats = options.formats});
  const auto results = run_all(options.settings);
  std::cout << passivity_table(results, text::colour_for(STDOUT_FILENO)) << std::flush << costs() << std::flush;
  if (!options.csv.empty()) text::write_file(options.csv, passivity_csv(results));
  if (!options.figure.empty())
    results::draw({.script = text::text_of(figure_scripts(), "leaks"), .csv = passivity_csv(results)}, options.figure,
                  options.formats);
}

}  // namespace

void add_passivity(CLI::App& app) {
  auto options = std::make_shared<PassivityOptions>();
  CLI::App* command = app.add_subcommand(
      "passivity",
      "Energy that each law leaks with real encoders, late ticks and latency, and the cost of the guarantee");
  command->add_option("--seeds", options->settings.seeds, "runs for each condition")
      ->check(program::whole_within(1, 1'000'000'000))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--from", options->settings.from, "the first seed")
      ->check(program::whole_within(0))
      ->type_name("SEED")
      ->capture_default_str();
  command->add_option("--seconds", options->settings.duration_s, "virtual seconds of each run")
      ->check(program::number_above_zero())
      ->type_name("SECONDS")
      ->capture_default_str();
  program::add_output(*command, "--csv", options->csv, "write every condition to this file, adversary by adversary")
      ->type_name("FILE.csv");
  program::add_figure(*command, options->figure, options->formats, "draw the leaks over the latency");
  command->footer("Example:\n  forcebound-lab passivity --seeds 1 --seconds 2 --figure leaks.png");
  command->callback([options] { run(*options); });
}

}  // namespace forcebound::lab
