#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "forcebound/program/command_line.hpp"
#include "forcebound/program/output_options.hpp"
#include "forcebound/program/progress.hpp"
#include "forcebound/results/draw.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/teleoperation/fault_study.hpp"
#include "tests/tools/lab/teleoperation/free_space_study.hpp"
#include "tests/tools/lab/teleoperation/impedance_study.hpp"
#include "tests/tools/lab/teleoperation/teleoperation_results.hpp"
#include "tests/tools/lab/teleoperation/teleoperation_study.hpp"
#include "tests/tools/lab/teleoperation/touch_study.hpp"
#include "tests/tools/lab/trials/option_checks.hpp"

namespace forcebound::lab {
namespace {

constexpr const char* kAll = "all";

struct TeleoperateOptions {
  TeleoperationStudy study;
  std::vector<std::string> tasks{kAll};
  std::vector<std::string> networks;
  std::string json;
  std::string csv;
  std::string figure;
  std::vector<std::string> formats;
  bool touches = false;
  bool faults = false;
  bool impedance = false;
  bool free_space = false;
};

std::vector<std::string> architecture_names() {
  std::vector<std::string> names;
  for (const server::ArchitectureKind& kind : server::architectures()) names.emplace_back(kind.name);
  return names;
}

std::string architectures_help() {
  std::string help;
  for (const server::ArchitectureKind& kind : server::architectures()) {
    help += "  " + std::string(kind.name);
    help.append(24 - kind.name.size(), ' ');
    help += kind.summary;
    help += '\n';
  }
  return help;
}

std::string tasks_help() {
  std::string help;
  for (const std::string& name : server::task_names()) {
    help += "  " + name;
    help.append(12 - std::min<std::size_t>(11, name.size()), ' ');
    help += server::load_task(name).summary + '\n';
  }
  return help;
}

void run(TeleoperateOptions& options) {
  results::prepare({.files = {options.json, options.csv}, .figures = {options.figure}, .formats = options.formats});
  TeleoperationStudy& study = options.study;
  study.tasks = options.tasks == std::vector<std::string>{kAll} ? server::task_names() : options.tasks;
  if (options.networks.empty() && options.free_space) {
    study.networks = free_space_networks();
  } else if (options.networks.empty()) {
    StandardNetworks standard = teleoperation_networks();
    report_left_out(standard.absent);
    study.networks = std::move(standard.networks);
  }
  for (const std::string& words : options.networks) study.networks.push_back(network_of(words));
  if (options.touches) {
    study.tasks = {"stiff-wall"};
    std::cout << touch_text(study_touches(study));
    return;
  }
  if (options.faults) {
    study.tasks = {"stiff-wall"};
    std::cout << fault_text(study_faults(study));
    return;
  }
  if (options.impedance) {
    std::cout << impedance_text(study_impedance(study), study.follower.workspace.force_scale *
                                                            study.follower.workspace.motion_scale *
                                                            server::load_task("stiff-wall").stiffness_N_per_m);
    return;
  }
  if (options.free_space) {
    std::cout << free_space_text(study_free_space(study));
    return;
  }
  std::vector<TeleoperationRow> rows;
  {
    program::Progress progress;
    rows = study_teleoperation(study, [&](double share) { progress.report(share, "teleoperation"); });
  }
  const std::vector<TeleoperationGroup> groups = groups_of(rows);
  const text::Table table = teleoperation_table(groups);
  std::cout << table.to_text(text::colour_for(STDOUT_FILENO)) << teleoperation_words(groups);
  if (!options.json.empty()) {
    std::string lines = "[\n";
    const nlohmann::ordered_json all = teleoperation_json(rows);
    for (std::size_t i = 0; i < all.size(); ++i) lines += all[i].dump() + (i + 1 < all.size() ? ",\n" : "\n");
    text::write_file(options.json, lines + "]\n");
  }
  if (!options.csv.empty()) text::write_file(options.csv, table.to_csv());
  if (!options.figure.empty()) results::draw(teleoperation_figure(groups), options.figure, options.formats);
}

void add_study(CLI::App& command, TeleoperateOptions& options) {
  TeleoperationStudy& study = options.study;
  command.add_option("tasks", options.tasks, "tasks, or files of such; all: those that ship")
      ->check(program::accepted_by([](const std::string& typed) {
        if (typed != kAll) (void)server::load_task(typed);
      }))
      ->type_name("TASK")
      ->delimiter(',')
      ->capture_default_str();
  command.add_option("--architectures", study.architectures, "which signals go which way; default: all, see below")
      ->check(program::accepted_by([](const std::string& typed) { (void)server::find_architecture(typed); }))
      ->type_name("NAMES")
      ->delimiter(',');
  command.add_option("--laws", study.laws, "laws, each at both ends")
      ->transform(known_law())
      ->type_name("LAWS")
      ->delimiter(',')
      ->capture_default_str();
  command
      .add_option("--network", options.networks,
                  "netem's words, none or trace:FILE, once for each; default: none, 10 and 50 ms each way, and the "
                  "recorded networks of FORCEBOUND_DATA")
      ->check(known_network())
      ->type_name("WORDS")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_option("--seeds", study.seeds, "runs of each: hands and networks differ")
      ->check(program::whole_within(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  command.add_option("--device", study.device, "in the hand, of three axes")
      ->check(known_device())
      ->type_name("DEVICE")
      ->capture_default_str();
  command
      .add_option("--robot-store", study.follower.initial_J,
                  "energy that the robot may spend before the hand gave any; default: the architecture's")
      ->check(program::number_within(0, 100))
      ->type_name("J");
  command.add_option("--motion-scale", study.follower.workspace.motion_scale, "the tool moves so many times as far")
      ->check(program::number_within(0.01, 100))
      ->type_name("M")
      ->capture_default_str();
  command.add_option("--force-scale", study.follower.workspace.force_scale, "the hand feels so many times the force")
      ->check(program::number_within(0.001, 100))
      ->type_name("K")
      ->capture_default_str();
}

/// Another question in place of the study's table, or where to write that.
void add_outcome(CLI::App& command, TeleoperateOptions& options) {
  std::vector<CLI::Option*> questions;
  const auto ask = [&](const char* name, bool& asked, const char* help) {
    CLI::Option* const question = command.add_flag(name, asked, help);
    for (CLI::Option* const other : questions) question->excludes(other);
    questions.push_back(question);
  };
  ask("--touches", options.touches,
      "how the stiff wall feels on a first and a second touch and as the hand slides along it, beside the same device "
      "without robot and network");
  ask("--faults", options.faults,
      "what robot and hand do when client, server, network or robot fail, with the first of the architectures, laws "
      "and networks");
  ask("--impedance", options.impedance,
      "what a hand that swings with 0.5 to 20 Hz meets, in free space and pressing the stiff wall");
  ask("--free-space", options.free_space,
      "what a hand feels of a robot that touches nothing, swinging by 5 and 50 mm, and how far the tool stays behind "
      "it; networks by default: none, 20, 50, 100 and 400 ms each way");
  for (CLI::Option* const output :
       {program::add_output(command, "--json", options.json, "write a row for each run to this file")
            ->type_name("FILE.json"),
        program::add_output(command, "--csv", options.csv, "write the table to this file")->type_name("FILE.csv"),
        program::add_figure(command, options.figure, options.formats, "draw force error and tracking error")}) {
    for (CLI::Option* const question : questions) output->excludes(question);
  }
}

}  // namespace

void add_teleoperate(CLI::App& app) {
  auto options = std::make_shared<TeleoperateOptions>();
  options->study.architectures = architecture_names();
  CLI::App* command =
      app.add_subcommand("teleoperate", "A robot arm at a task, led by a hand through a network, in virtual time");
  add_study(*command, *options);
  add_outcome(*command, *options);
  command->footer("Tasks:\n" + tasks_help() + "\nArchitectures:\n" + architectures_help() +
                  "\n"
                  "Both ends are bounded by the law: the device by its own damping, the robot by that of its joints "
                  "and what the law at the device gave up. Client, server and follower are those of the programs.\n"
                  "\n"
                  "Examples:\n"
                  "  forcebound-lab teleoperate plug --network 'delay 50ms' --seeds 5\n"
                  "  forcebound-lab teleoperate all --json all.json --figure all.png");
  command->callback([options] { run(*options); });
}

}  // namespace forcebound::lab
