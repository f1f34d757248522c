#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/law_plugin/known_laws.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/output_options.hpp"
#include "forcebound/program/progress.hpp"
#include "forcebound/results/draw.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/printable.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/comparison/comparison_figure.hpp"
#include "tests/tools/lab/comparison/comparison_run.hpp"
#include "tests/tools/lab/comparison/standing.hpp"
#include "tests/tools/lab/figures/figure_scripts.hpp"
#include "tests/tools/lab/trials/option_checks.hpp"
#include "tests/tools/lab/trials/task.hpp"

namespace forcebound::lab {
namespace {

constexpr const char* kComparisonPicture = "comparison.png";
constexpr const char* kLimitsPicture = "limits.png";

struct CompareOptions {
  std::vector<std::string> laws;
  std::vector<std::string> scenes{"wall", "circle", "sphere"};
  std::vector<std::string> networks;
  std::string device;
  std::vector<double> stiffnesses_N_per_m{2e3, 10e3, 50e3};
  std::vector<double> delays_ms{0, 1, 10, 50};
  bool no_limits = false;
  std::string from;
  std::uint64_t seeds = 1;
  std::uint64_t seed = 1;
  bool renders_locally = false;
  int effort = 16;
  std::string csv;
  std::string json;
  std::string readme;
  std::string figures;
  std::vector<std::string> formats;
};

ComparisonSettings settings_of(const CompareOptions& options) {
  ComparisonSettings settings{.laws = options.laws,
                              .tasks = {},
                              .networks = {},
                              .stiffnesses_N_per_m = options.stiffnesses_N_per_m,
                              .delays_s = {},
                              .seeds = options.seeds,
                              .effort = options.effort,
                              .seed = options.seed,
                              .renders_locally = options.renders_locally};
  if (settings.laws.empty()) settings.laws = law_plugin::known_laws().names();
  for (const std::string& scene : options.scenes) settings.tasks.push_back(task_of(scene, options.device));
  for (const std::string& words : options.networks) settings.networks.push_back(network_of(words));
  if (settings.networks.empty()) {
    StandardNetworks standard = standard_networks();
    settings.networks = std::move(standard.networks);
    report_left_out(standard.absent);
  }
  if (!options.no_limits) {
    for (const double ms : options.delays_ms) settings.delays_s.push_back(1e-3 * ms);
  }
  return settings;
}

nlohmann::ordered_json run_standings(const CompareOptions& options) {
  program::Progress progress;
  const ComparisonResult result =
      run_comparison(settings_of(options), time::SteadyClock(), [&](std::size_t done, std::size_t all) {
        progress.report(static_cast<double>(done) / static_cast<double>(all),
                        std::to_string(done) + " of " + std::to_string(all) + " steps");
      });
  progress.clear();
  if (!options.csv.empty()) text::write_file(options.csv, to_csv(result));
  return standings(result);
}

nlohmann::ordered_json read_standings(const std::string& file) {
  auto standings = nlohmann::ordered_json::parse(text::read_file(file), nullptr, false);
  if (!standings.is_object() || !standings.contains("laws")) {
    throw std::runtime_error(file + ": not a comparison's standings; expected the output of --json");
  }
  return standings;
}

std::vector<std::string> compared_inputs(const CompareOptions& options) {
  std::vector<std::string> inputs{options.from, options.device};
  inputs.reserve(inputs.size() + options.networks.size());
  for (const std::string& words : options.networks) inputs.push_back(recorded_network(words));
  return inputs;
}

void compare(const CompareOptions& options) {
  results::prepare({.inputs = compared_inputs(options),
                    .files = {options.csv, options.json},
                    .page = options.readme,
                    .marks = kComparisonMarks,
                    .folder = options.figures,
                    .figures = results::pictures_in(options.figures, {kComparisonPicture, kLimitsPicture}),
                    .formats = options.formats});
  const auto told = options.from.empty() ? run_standings(options) : read_standings(options.from);
  std::fputs(text::printable_lines(to_text(told)).c_str(), stdout);
  if (!options.json.empty()) text::write_file(options.json, told.dump(2) + '\n');
  if (!options.readme.empty()) {
    text::write_file(options.readme, results::page_with(options.readme, kComparisonMarks, comparison_markdown(told)));
  }
  if (options.figures.empty()) return;
  const std::filesystem::path directory(options.figures);
  const auto comparison =
      results::draw({.script = text::text_of(figure_scripts(), "comparison"), .csv = comparison_csv(told)},
                    directory / kComparisonPicture, options.formats);
  std::printf("\nFigures:\n  %s\n", comparison.c_str());
  if (told.at("limits").empty()) return;
  std::printf("  %s\n", results::draw({.script = text::text_of(figure_scripts(), "limits"), .csv = limits_csv(told)},
                                      directory / kLimitsPicture, options.formats)
                            .c_str());
}

}  // namespace

void add_compare(CLI::App& app) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command = app.add_subcommand(
      "compare", "Compare the laws: the same device, hand, scene and network for each, with its best parameters");
  command->footer("Laws:\n" + law_plugin::known_laws().help() +
                  "\nExample:\n  forcebound-lab compare --laws fba-less,tdpa --scenes wall --network none \\\n"
                  "    --network \"delay 20ms loss 5%\"");
  command->add_option("--laws", options->laws, "laws to compare; default: all")
      ->delimiter(',')
      ->transform(known_law())
      ->type_name("LAW,LAW,...");
  command->add_option("--scenes", options->scenes, "scenes of the paper: wall, circle, sphere")
      ->delimiter(',')
      ->check(program::accepted_by([](const std::string& scene) { (void)task_of(scene); }))
      ->type_name("SCENE,SCENE,...")
      ->default_str("wall,circle,sphere");
  command
      ->add_option("--network", options->networks,
                   "the network in both directions: none, netem's words, or trace:FILE; may be repeated; "
                   "default: none, 1 to 250 ms, jitter, loss, bursts, and the 5G networks of FORCEBOUND_DATA")
      ->check(known_network())
      ->type_name("\"WORDS\"")
      ->allow_extra_args(false);
  command->add_option("--device", options->device, "device to use instead of the scene's own")
      ->check(known_device())
      ->type_name("NAME|FILE.toml");
  command->add_option("--stiffness", options->stiffnesses_N_per_m, "stiffness of the walls [N/m]")
      ->delimiter(',')
      ->check(program::number_above_zero())
      ->type_name("K,K,...")
      ->default_str("2000,10000,50000");
  command
      ->add_option("--delays", options->delays_ms, "one-way delays at which to look for the stiffest wall at rest [ms]")
      ->delimiter(',')
      ->check(program::number_within(0, 1000))
      ->type_name("MS,MS,...")
      ->default_str("0,1,10,50");
  add_rendering_option(*command, options->renders_locally);
  command->add_flag("--no-limits", options->no_limits, "do not look for the stiffest wall");
  command->add_option("--seeds", options->seeds, "runs of each trial")
      ->check(program::whole_within(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--seed", options->seed, "seed of the first run and of the search for parameters")
      ->check(program::whole_within(0))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--effort", options->effort,
                   "sets of parameters to try for each law that has any; 1: its standard ones")
      ->check(program::whole_within(1, 10000))
      ->type_name("N")
      ->capture_default_str();
  CLI::Option* const from =
      command->add_option("--from", options->from, "print and draw the standings that --json wrote, without any run")
          ->type_name("FILE.json");
  program::add_output(*command, "--csv", options->csv, "write a row for each run to this file")
      ->excludes(from)
      ->type_name("FILE.csv");
  program::add_output(*command, "--json", options->json, "write the standings to this file")
      ->excludes(from)
      ->type_name("FILE.json");
  program::add_output(*command, "--readme", options->readme, "put tables between the marks of this file")
      ->type_name("PAGE.md");
  program::add_figures(*command, options->figures, options->formats,
                       "draw stability, transparency and the stiffest walls");
  command->callback([options] { compare(*options); });
}

}  // namespace forcebound::lab
