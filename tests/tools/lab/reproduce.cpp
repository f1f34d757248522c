#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/experiment_run.hpp"
#include "tests/tools/lab/laws_figure.hpp"

namespace forcebound::lab {
namespace {

using nlohmann::json;

struct ReproduceOptions {
  std::string experiment = "all";
  std::string json;
  std::string figures;
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
  std::printf("\n%s\n  device  %s\n  hand    %s\n\n", experiment.title().c_str(), describe(device).c_str(),
              hand.description().c_str());
  std::printf("  %-10s %12s %12s %12s %12s %12s %10s   %s\n", "law", "P min [J]", "K [N/mm]", "mean F [N]",
              "var F [N2]", "direction", "rings [s]", "the paper");
}

void print_row(const Experiment& experiment, const ExperimentRun& run) {
  const json& s = run.summary;
  std::printf("  %-10s %12.3g %12.2f %12.3f %12.3g %12.2g %10.3f   %s\n", run.law.c_str(),
              number(s["passivity"]["minimum_J"]), number(s["displayed_stiffness_N_per_m"]["mean"]) * 1e-3,
              number(s["force_N"]["mean"]), number(s["force_N"]["variance"]), run.direction_error_rad,
              run.ringing_s.value_or(std::nan("")), paper_says(experiment, run.law).c_str());
}

std::ofstream open(const std::string& file) {
  std::ofstream out;
  if (file.empty()) return out;
  out.open(file);
  if (!out) throw std::runtime_error("cannot write '" + file + "': " + std::generic_category().message(errno));
  return out;
}

void reproduce(const ReproduceOptions& options) {
  std::ofstream file = open(options.json);
  json runs = json::array();
  std::vector<std::filesystem::path> drawn;
  std::printf("Kim, Baek, Ryu 2015, section VI, each law in turn. Masses and hands are ours: the paper gives none.\n");
  for (const Experiment& experiment : experiments(options.experiment)) {
    const auto settings = experiment.settings("none");
    const auto hand = device::make_operator(experiment.hand, settings.device.facts.degrees_of_freedom());
    print_heading(experiment, settings.device, *hand);
    LawsFigure figure(experiment.title(), "same device, same hand, three laws");
    for (const std::string& law : control::force_bounding_laws().names()) {
      const ExperimentRun done = run_experiment(experiment, law, options.figures.empty() ? nullptr : &figure);
      print_row(experiment, done);
      runs.push_back(to_json(experiment, done, hand->hand()));
    }
    if (!options.figures.empty()) drawn.push_back(figure.draw_into(options.figures));
  }
  if (file.is_open() && !(file << runs.dump(2) << '\n').flush()) {
    throw std::runtime_error("cannot write all of '" + options.json + "': " + std::generic_category().message(errno));
  }
  for (const auto& png : drawn) std::printf("%s%s\n", &png == &drawn.front() ? "\nFigures:\n  " : "  ", png.c_str());
}

}  // namespace

void add_reproduce(CLI::App& app) {
  auto options = std::make_shared<ReproduceOptions>();
  CLI::App* command = app.add_subcommand(
      "reproduce", "Run the paper's experiments with each law, and print what they show beside the paper's figures");
  command->add_option("EXPERIMENT", options->experiment, "which")
      ->check(CLI::IsMember({"wall", "delay", "circle", "sphere", "all"}))
      ->capture_default_str();
  command->add_option("--json", options->json, "write the runs to this file, an array with one object for each")
      ->type_name("FILE");
  command
      ->add_option("--figures", options->figures,
                   "draw position, force, energy and displayed stiffness into this directory")
      ->type_name("DIR");
  command->callback([options] { reproduce(*options); });
}

}  // namespace forcebound::lab
