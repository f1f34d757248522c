#include <unistd.h>
#include <CLI/CLI.hpp>

#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/client/commands/identify/guide_options.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/output_options.hpp"
#include "forcebound/program/progress.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/identification/study.hpp"

namespace forcebound::lab {
namespace {

using identification::StudyDevice;

struct IdentificationOptions {
  client::commands::identify::GuideOptions identify{};
  std::uint64_t devices = 500;
  std::string csv;
};

void run(const IdentificationOptions& options) {
  results::prepare({.files = {options.csv}});
  const std::vector<StudyDevice> devices = [&] {
    program::Progress progress;
    return identification::study_devices(
        {.devices = options.devices,
         .seed = options.identify.guide.seed,
         .confidence = options.identify.confidence,
         .guide = options.identify.guide},
        [&](std::uint64_t done) {
          progress.report(static_cast<double>(done) / static_cast<double>(options.devices),
                          std::to_string(done) + " of " + std::to_string(options.devices) + " devices");
        });
  }();
  std::cout << text::counted(options.devices, "simulated device", "simulated devices") << " with hidden facts, seed "
            << options.identify.guide.seed << ". "
            << identification::study_text(devices, text::colour_for(STDOUT_FILENO)) << std::flush;
  if (!options.csv.empty()) text::write_file(options.csv, identification::study_csv(devices));
  if (identification::any_wrong(devices)) throw std::runtime_error("a bound is wrong, see the table");
}

}  // namespace

void add_identification(CLI::App& app) {
  auto options = std::make_shared<IdentificationOptions>();
  CLI::App* command = app.add_subcommand(
      "identification",
      "What `forcebound identify` finds of simulated devices, beside the truth that is hidden from it");
  command->add_option("--devices", options->devices, "how many")
      ->check(program::whole_within(1, 1'000'000))
      ->type_name("N")
      ->capture_default_str();
  client::commands::identify::add_guide_options(*command, options->identify, "of the hidden devices");
  program::add_output(*command, "--csv", options->csv, "a row for each device")->type_name("FILE.csv");
  command->footer(
      "Ends with 1 where a bound is wrong.\n"
      "\n"
      "Example:\n"
      "  forcebound-lab identification --devices 500 --seed 1");
  command->callback([options] { run(*options); });
}

}  // namespace forcebound::lab
