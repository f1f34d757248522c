#include "forcebound/client/commands/commands.hpp"

#include <CLI/CLI.hpp>
#include <cerrno>
#include <fstream>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "forcebound/baselines/law_file.hpp"
#include "forcebound/client/commands/replay/csv_reader.hpp"
#include "forcebound/client/commands/replay/replay.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/law_plugin/known_laws.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/lines.hpp"

namespace forcebound::client::commands {
namespace {

/// The options as typed: lists are taken apart here, not by the command line, so that a message names the number.
struct ReplayArguments {
  ReplayOptions options;
  std::string damping;
  std::string damping_matrix;
  std::string encoder;
  std::string friction;
  std::string memory = "capped";
  std::string law_parameters;
  std::string input = "-";
  std::string output = "-";
};

std::vector<double> numbers_of(const std::string& option, std::string_view text) {
  std::vector<double> numbers;
  if (text.empty()) return numbers;
  for (const std::string_view field : text::split(text, ',')) {
    try {
      numbers.push_back(parse_number(field));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(option + ": " + error.what() + "; numbers separated by commas were expected");
    }
  }
  return numbers;
}

ReplayOptions options_of(const ReplayArguments& arguments) {
  ReplayOptions options = arguments.options;
  options.laws = law_plugin::known_laws();
  options.damping_N_s_per_m = numbers_of("--damping", arguments.damping);
  options.encoder_step_m = numbers_of("--encoder", arguments.encoder);
  options.friction_N = numbers_of("--friction", arguments.friction);
  options.law_options.memory = arguments.memory == "full" ? control::EnergyMemory::full : control::EnergyMemory::capped;
  if (!arguments.law_parameters.empty()) {
    options.law_options.parameters =
        baselines::load_law_parameters(arguments.law_parameters, options.law, options.laws);
  }
  if (!arguments.damping_matrix.empty()) {
    options.damping_matrix.emplace();
    for (const std::string_view row : text::split(arguments.damping_matrix, ';')) {
      options.damping_matrix->push_back(numbers_of("--damping-matrix", row));
    }
  }
  return options;
}

/// @param failed what is said of it: "cannot be read"
template <typename Stream>
Stream opened(const std::string& path, const char* failed) {
  Stream stream(path);
  if (!stream) throw std::runtime_error(path + ": " + failed + ": " + std::generic_category().message(errno));
  return stream;
}

void report(const ReplayCounts& counts, const std::string& input) {
  if (const std::string doubt = counts.pace.doubt_of_units(); !doubt.empty()) {
    std::cerr << "note: " << input << ' ' << doubt << '\n';
  }
  if (counts.requests_not_finite > 0) {
    std::cerr << "note: " << counts.requests_not_finite << " of " << counts.rows
              << " rows asked for a force that is not finite: zero force\n";
  }
  if (counts.readings_not_finite > 0) {
    std::cerr << "note: " << counts.readings_not_finite << " of " << counts.rows
              << " rows had a position that is not finite: zero force, and the ledger is charged the worst case\n";
  }
  if (counts.intervals_impossible > 0) {
    std::cerr << "note: " << counts.intervals_impossible << " of " << counts.rows
              << " rows came 0 s or less after the row before, or more than 1e6 s: nothing is credited, the worst case "
                 "charged\n";
  }
}

void run(const ReplayArguments& arguments) {
  const ReplayOptions options = options_of(arguments);
  std::ifstream input_file;
  std::ofstream output_file;
  if (arguments.input != "-" && text::is_same_path(arguments.input, arguments.output)) {
    throw std::invalid_argument("--output " + arguments.output + " would replace --input");
  }
  if (arguments.input != "-") input_file = opened<std::ifstream>(arguments.input, "cannot be read");
  if (arguments.output != "-") output_file = opened<std::ofstream>(arguments.output, "cannot be written");
  const ReplayInput input =
      arguments.input == "-" ? ReplayInput{std::cin, "<stdin>"} : ReplayInput{input_file, arguments.input};
  report(replay(options, input, arguments.output == "-" ? std::cout : output_file), input.name);
}

}  // namespace

void add_replay(CLI::App& program) {
  const auto arguments = std::make_shared<ReplayArguments>();
  ReplayOptions& options = arguments->options;
  CLI::App* command = program.add_subcommand("replay", "A law over recorded rows, or rows as they come");
  command->footer(
      "Reads   time_s,x0_m[,x1_m..],fe0_N[,fe1_N..]\n"
      "        readings, and the force that the environment asks for\n"
      "writes  time_s,f0_N[,f1_N..],energy_J,xi\n"
      "        the force on the device that the law allows\n"
      "With --input - each row is answered as it comes, so that a simulator can close the loop through a pipe.\n"
      "\n"
      "Laws:\n" +
      law_plugin::known_laws().help() +
      "\nExample:\n"
      "  forcebound replay --law fba-more --damping 30 --period 1e-3 \\\n"
      "    --input press.csv --output bounded.csv");
  command->add_option("--law", options.law, "law to run, see below")
      ->required()
      ->type_name("LAW|FILE.so")
      ->transform(program::replaced_by(law_plugin::law_of_option));
  command
      ->add_option("--law-parameters", arguments->law_parameters,
                   "a table for each law: [vc], coupling_N_per_m = 40000")
      ->type_name("FILE.toml");
  command->add_option("--damping", arguments->damping, "damping lower bound [N s/m], one for all axes or b1,b2,..")
      ->type_name("B[,B..]");
  command
      ->add_option("--damping-matrix", arguments->damping_matrix,
                   "full damping matrix [N s/m], rows like \"a,b;c,d\"; takes the place of --damping")
      ->type_name("\"ROWS\"");
  const auto add_number = [&](const char* name, auto& value, const char* what) {
    return command->add_option(name, value, what)->check(program::number())->type_name("NUMBER");
  };
  add_number("--period", options.period_s, "nominal period of a tick [s]")->capture_default_str();
  command->add_option("--encoder", arguments->encoder, "distance of neighbouring readings [m], one or q1,q2,..")
      ->type_name("Q[,Q..]");
  command->add_option("--friction", arguments->friction, "Coulomb friction lower bound [N], one or c1,c2,..")
      ->type_name("C[,C..]");
  add_number("--hold", options.hold_s,
             "the device zeroes a force after this time [s]; default: the law assumes the period, the device never "
             "does");
  add_number("--latency", options.latency_s, "time from reading to force [s]")->capture_default_str();
  add_number("--force-max", options.force_N_max, "largest force asked of the law [N]; default: no limit");
  command
      ->add_option("--memory", arguments->memory,
                   "energy that may be saved: as much as the largest force can need, or all")
      ->check(program::one_of("memory", {"capped", "full"}))
      ->type_name("capped|full")
      ->capture_default_str();
  command->add_option("--input", arguments->input, "rows to read, or - for standard input")
      ->type_name("FILE.csv")
      ->capture_default_str();
  command->add_option("--output", arguments->output, "file to write, or - for standard output")
      ->type_name("FILE.csv")
      ->capture_default_str();
  command->callback([arguments] { run(*arguments); });
}

}  // namespace forcebound::client::commands
