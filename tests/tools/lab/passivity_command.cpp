#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <memory>
#include <system_error>

#include "forcebound/control/law_registry.hpp"
#include "tests/tools/lab/above_zero.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/experiment_run.hpp"
#include "tests/tools/lab/passivity.hpp"
#include "tests/tools/lab/progress.hpp"

namespace forcebound::lab {
namespace {

struct PassivityOptions {
  PassivitySettings settings;
  std::string csv;
  std::string figure;
};

/// The cost of the guarantee: the paper's walls with each law.
void print_costs() {
  std::printf(
      "\nIts cost: displayed stiffness at rest and ringing on the paper's walls\n(30 N s/m, encoder 15 um).\n\n  "
      "%-10s",
      "law");
  const auto walls = experiments("wall");
  for (const Experiment& wall : walls) std::printf("  %4.0f N/mm, rings", wall.stiffness_N_per_m * 1e-3);
  std::printf("\n");
  for (const std::string& law : control::force_bounding_laws().names()) {
    std::printf("  %-10s", law.c_str());
    for (const Experiment& wall : walls) {
      const ExperimentRun run = run_experiment(wall, law, nullptr);
      const double shown_N_per_mm = run.displayed_stiffness_N_per_m() * 1e-3;
      char shown[24] = "no rest";
      if (std::isfinite(shown_N_per_mm)) std::snprintf(shown, sizeof shown, "%.1f N/mm", shown_N_per_mm);
      std::printf("  %10s, %4.2f s", shown, run.ringing_s.value_or(std::nan("")));
    }
    std::printf("\n");
  }
}

std::vector<PassivityResult> run_all(const PassivitySettings& settings) {
  const auto conditions = passivity_conditions();
  Progress progress;
  std::vector<PassivityResult> results;
  for (const PassivityCondition& condition : conditions) {
    progress.tell(static_cast<double>(results.size()) / static_cast<double>(conditions.size()),
                  std::to_string(results.size()) + " of " + std::to_string(conditions.size()) + " conditions");
    results.push_back(worst_passivity(condition, settings));
  }
  return results;
}

void run(const PassivityOptions& options) {
  std::ofstream csv;
  if (!options.csv.empty()) {
    csv.open(options.csv);
    if (!csv) throw std::runtime_error("cannot write '" + options.csv + "': " + std::generic_category().message(errno));
  }
  const auto results = run_all(options.settings);
  print_passivity(std::cout, results);
  std::cout.flush();
  print_costs();
  if (csv.is_open()) {
    write_passivity_csv(csv, results);
    if (!csv.flush()) throw std::runtime_error("cannot write all of '" + options.csv + "'");
  }
  if (!options.figure.empty()) draw_passivity(options.figure, results);
}

}  // namespace

void add_passivity(CLI::App& app) {
  auto options = std::make_shared<PassivityOptions>();
  CLI::App* command = app.add_subcommand(
      "passivity",
      "Energy that each law leaks with real encoders, late ticks and latency, and the cost of the guarantee");
  command->add_option("--seeds", options->settings.seeds, "runs for each condition")
      ->check(above_zero())
      ->capture_default_str();
  command->add_option("--from", options->settings.from, "the first seed")->capture_default_str()->type_name("SEED");
  command->add_option("--seconds", options->settings.duration_s, "virtual seconds of each run")
      ->check(above_zero())
      ->capture_default_str();
  command->add_option("--csv", options->csv, "write every condition to this file, adversary by adversary")
      ->type_name("FILE");
  command->add_option("--figure", options->figure, "draw the leaks over the latency into this file")
      ->type_name("FILE.png");
  command->callback([options] { run(*options); });
}

}  // namespace forcebound::lab
