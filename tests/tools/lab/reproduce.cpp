#include <unistd.h>
#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/output_options.hpp"
#include "forcebound/program/progress.hpp"
#include "forcebound/results/laws_figure.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/results/summary_cells.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/names.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/experiment_run.hpp"
#include "tests/tools/lab/trials/option_checks.hpp"

namespace forcebound::lab {
namespace {

using nlohmann::json;

struct ReproduceOptions {
  std::string experiment = "all";
  bool renders_locally = false;
  std::string json;
  std::string figures;
  std::vector<std::string> formats;
};

json to_json(const Experiment& experiment, const ExperimentRun& run, const device::Hand& hand) {
  json object = run.summary;
  object["experiment"] = experiment.name;
  object["stiffness_N_per_m"] = experiment.stiffness_N_per_m;
  object["encoder_m"] = experiment.encoder_m;
  object["one_way_delay_s"] = experiment.one_way_delay_s;
  object["ringing_s"] = run.ringing_s ? json(*run.ringing_s) : json(nullptr);
  object["direction_error_rad_max"] = run.direction_error_rad;
  object["hand"] = {{"mass_kg", hand.mass_kg},
                    {"stiffness_N_per_m", hand.stiffness_N_per_m},
                    {"damping_N_s_per_m", hand.damping_N_s_per_m}};
  return object;
}

double number(const json& value) { return value.is_number() ? value.get<double>() : std::nan(""); }

std::string paper_says(const Experiment& experiment, const std::string& law) {
  for (const PaperFigure& figure : experiment.paper) {
    if (figure.law == law) return figure.text;
  }
  return "-";
}

void print_heading(const Experiment& experiment, const device::DeviceDescription& device,
                   const device::Operator& hand) {
  const std::string heading =
      "\n" + experiment.title() + "\n  device  " + describe(device) + "\n  hand    " + hand.description() + "\n\n";
  std::fputs(text::wrapped_below_descriptions(heading, 0).c_str(), stdout);
}

/// Three significant digits; "-" for what is not a number.
std::string cell(double value) { return std::isfinite(value) ? text::rounded(value) : "-"; }

/// A direction error within rounding counts as 0.
double degrees(double angle_rad) {
  constexpr double kRounding_deg = 1e-6;
  const double angle_deg = angle_rad * 180 / std::numbers::pi;
  return angle_deg < kRounding_deg ? 0 : angle_deg;
}

text::Table empty_table() {
  return text::Table({{"law"},
                      {"least P", "mJ"},
                      {"K", "N/mm"},
                      {"mean F", "N"},
                      {"var F", "N^2"},
                      {"bent by", "deg"},
                      {"rings", "s"},
                      {"the paper", "", text::Table::Align::left}});
}

void add_row(text::Table& table, const Experiment& experiment, const ExperimentRun& run) {
  const json& s = run.summary;
  table.add({run.law, results::least_P_cell(s), cell(run.displayed_stiffness_N_per_m() * 1e-3),
             cell(number(s["force_N"]["mean"])), cell(number(s["force_N"]["variance"])),
             cell(degrees(run.direction_error_rad)), cell(run.ringing_s.value_or(std::nan(""))),
             paper_says(experiment, run.law)});
}

std::filesystem::path picture_of(const Experiment& experiment, const std::string& folder) {
  return std::filesystem::path(folder) / results::LawsFigure::picture_name(experiment.title());
}

std::vector<std::filesystem::path> pictures_of(const std::vector<Experiment>& all, const std::string& folder) {
  std::vector<std::filesystem::path> pictures;
  if (folder.empty()) return pictures;
  pictures.reserve(all.size());
  for (const Experiment& experiment : all) pictures.push_back(picture_of(experiment, folder));
  return pictures;
}

void reproduce(const ReproduceOptions& options) {
  std::vector<Experiment> all = experiments(options.experiment);
  for (Experiment& experiment : all) experiment.renders_locally = options.renders_locally;
  results::prepare({.files = {options.json},
                    .folder = options.figures,
                    .figures = pictures_of(all, options.figures),
                    .formats = options.formats});
  json runs = json::array();
  std::vector<std::filesystem::path> drawn;
  std::printf(
      "Kim, Baek, Ryu 2015, section VI, each law in turn. Masses and hands are ours:\n"
      "the paper gives none. Least P below 0: not passive. K: displayed stiffness,\n"
      "median while the contact rests (depth changes by < 5 mm/s), of the true surface;\n"
      "-: it never rests. The paper's own K is a mean.\n");
  if (options.renders_locally) {
    std::printf("With local rendering, which the paper does not have.\n");
  }
  const auto laws = control::force_bounding_laws().names();
  program::Progress progress;
  for (const Experiment& experiment : all) {
    const auto settings = experiment.settings("none");
    const auto hand = device::make_operator(experiment.hand, settings.device.facts);
    print_heading(experiment, settings.device, *hand);
    text::Table table = empty_table();
    results::LawsFigure figure(experiment.title(), "each law on the same device, with the same hand");
    for (const std::string& law : laws) {
      progress.report(static_cast<double>(runs.size()) / static_cast<double>(all.size() * laws.size()),
                      std::to_string(runs.size()) + " of " + std::to_string(all.size() * laws.size()) + " runs");
      const ExperimentRun done = run_experiment(experiment, law, options.figures.empty() ? nullptr : &figure);
      progress.clear();
      add_row(table, experiment, done);
      runs.push_back(to_json(experiment, done, hand->hand()));
    }
    std::fputs(table.to_text(text::colour_for(STDOUT_FILENO)).c_str(), stdout);
    std::fflush(stdout);
    if (!options.figures.empty())
      drawn.push_back(figure.draw_to(picture_of(experiment, options.figures), options.formats));
  }
  if (!options.json.empty()) text::write_file(options.json, runs.dump(2) + '\n');
  for (const auto& png : drawn) std::printf("%s%s\n", &png == &drawn.front() ? "\nFigures:\n  " : "  ", png.c_str());
}

}  // namespace

void add_reproduce(CLI::App& app) {
  auto options = std::make_shared<ReproduceOptions>();
  CLI::App* command = app.add_subcommand(
      "reproduce", "Run the paper's experiments with each law, and print their figures beside the paper's");
  std::vector<std::string> names = experiment_names();
  names.emplace_back("all");
  command->add_option("EXPERIMENT", options->experiment, text::join(names))
      ->check(program::one_of("experiment", names))
      ->capture_default_str();
  add_rendering_option(*command, options->renders_locally);
  program::add_output(*command, "--json", options->json,
                      "write the runs to this file, an array with one object for each")
      ->type_name("FILE.json");
  program::add_figures(*command, options->figures, options->formats, "draw force, depth and passivity with each law");
  command->footer("Example:\n  forcebound-lab reproduce sphere --figures out");
  command->callback([options] { reproduce(*options); });
}

}  // namespace forcebound::lab
