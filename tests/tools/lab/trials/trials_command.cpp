#include <unistd.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/output_options.hpp"
#include "forcebound/program/progress.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/results/runs_table.hpp"
#include "forcebound/scene/scene.hpp"
#include "forcebound/server/environment/scene_library.hpp"
#include "forcebound/server/environment/suggested_hand.hpp"
#include "forcebound/text/file.hpp"
#include "tests/tools/lab/trials/option_checks.hpp"
#include "tests/tools/lab/trials/task.hpp"
#include "tests/tools/lab/trials/trials.hpp"

namespace forcebound::lab {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  TrialsSettings settings{
      .scene = "dome", .device = {}, .hand = {}, .network = "delay 50ms 10ms loss 5%", .laws = {"fba-exact", "none"}};
  std::vector<std::string> live;
  std::string json;
  std::string figure;
  std::vector<std::string> formats;
};

/// Device and hand that were not given are those that the scene suggests.
void complete(TrialsSettings& settings) {
  if (!settings.device.empty() && !settings.hand.empty()) return;
  const server::SuggestedHand suggested = server::suggested_hand(server::load_scene(settings.scene));
  if (settings.device.empty()) settings.device = suggested.device;
  if (settings.hand.empty()) settings.hand = suggested.hand;
}

std::vector<std::string> inputs_of(const Options& options) {
  std::vector<std::string> inputs = options.live;
  inputs.push_back(options.settings.scene);
  inputs.push_back(options.settings.device);
  inputs.push_back(device::recorded_hand(options.settings.hand));
  inputs.push_back(recorded_network(options.settings.network));
  return inputs;
}

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

void run(Options options) {
  complete(options.settings);
  results::prepare(
      {.inputs = inputs_of(options), .files = {options.json}, .figures = {options.figure}, .formats = options.formats});
  expect_accepted(*server::load_scene(options.settings.scene), options.settings.device);
  program::value_of("--operator", [&] {
    (void)device::make_operator(options.settings.hand, device::load_device(options.settings.device).facts);
  });
  std::vector<Json> live;
  for (const std::string& file : options.live) live.push_back(results::read_summary(file));
  results::LawsFigure figure("What is felt on " + options.settings.scene + " with each law and rendering",
                             "through \"" + options.settings.network + "\" each way, virtual time; " +
                                 options.settings.device + ", " + options.settings.hand);
  std::vector<PlayedTrial> trials;
  {
    program::Progress progress;
    trials = play_trials(options.settings, options.figure.empty() ? nullptr : &figure,
                         [&](double share) { progress.report(share, "running the trials"); });
  }
  std::fputs(trials_table(options.settings, trials, text::colour_for(STDOUT_FILENO)).c_str(), stdout);
  if (!live.empty()) std::printf("\n%s", timing_table(live).c_str());
  if (!options.figure.empty()) figure.draw_to(options.figure, options.formats);
  if (options.json.empty()) return;
  Json all = Json::array();
  for (const PlayedTrial& trial : trials) {
    all.push_back({{"law", trial.law},
                   {"rendering", trial.rendering},
                   {"refused", trial.refused},
                   {"ringing_s", or_null(trial.ringing_s)},
                   {"off_by", or_null(trial.off_by)},
                   {"rotational_stiffness_N_m_per_rad", or_null(trial.rotational_N_m_per_rad)},
                   {"push_N", trial.push_N},
                   {"summary", trial.summary}});
  }
  text::write_file(options.json, all.dump(2) + '\n');
}

}  // namespace

void add_trials(CLI::App& app) {
  auto options = std::make_shared<Options>();
  TrialsSettings& settings = options->settings;
  CLI::App* command = app.add_subcommand(
      "trials",
      "One scene, device, hand and network with each law and rendering, in virtual time: figures that repeat");
  command->add_option("SCENE", settings.scene, "name or FILE.toml")->check(known_scene())->capture_default_str();
  command->add_option("--device", settings.device, "as the client's")
      ->check(known_device())
      ->type_name("NAME|FILE.toml")
      ->default_str("what the scene suggests");
  command->add_option("--operator", settings.hand, "as the client's")
      ->type_name("SPEC")
      ->default_str("what the scene suggests");
  command
      ->add_option("--netem", settings.network,
                   "the network in both directions, as in the relay; or none, or trace:FILE")
      ->check(known_network())
      ->type_name("\"WORDS\"")
      ->capture_default_str();
  command->add_option("--laws", settings.laws, "laws to run, each alone")
      ->delimiter(',')
      ->transform(known_law())
      ->type_name("LAW,LAW,...")
      ->default_str("fba-exact,none");
  command
      ->add_option("--rendering", settings.renderings,
                   "where forces are computed, each alone: remote, at the server; local, what can be at the client")
      ->delimiter(',')
      ->check(program::one_of("rendering", {"local", "remote"}))
      ->type_name("WHERE,WHERE")
      ->default_str("local,remote");
  command->add_option("--seconds", settings.duration_s, "virtual seconds of each run")
      ->type_name("SECONDS")
      ->check(program::number_above_zero())
      ->capture_default_str();
  command->add_option("--seed", settings.seed, "of the network and of the ticks' lateness")
      ->type_name("N")
      ->check(program::whole_within(0))
      ->capture_default_str();
  command->add_option("--live", options->live, "summaries of live runs, whose timing is printed too")
      ->type_name("FILE.json");
  program::add_output(*command, "--json", options->json, "write all figures to this file")->type_name("FILE.json");
  program::add_figure(*command, options->figure, options->formats, "draw the runs side by side");
  command->footer(
      "Server, client, device and hand are those of the programs; the clock and the network are simulated, and ticks "
      "are as late as measured on a shared machine. The same options give the same figures on every machine.\n"
      "\n"
      "Example:\n"
      "  forcebound-lab trials dome --netem \"delay 50ms 10ms loss 5%\"");
  command->callback([options] { run(*options); });
}

}  // namespace forcebound::lab
