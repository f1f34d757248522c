#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "forcebound/client/commands/check_device/checked_process.hpp"
#include "forcebound/client/commands/commands.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/output_options.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::client::commands {
namespace {

struct CheckDeviceOptions {
  CheckDeviceRequest request;
  std::string json;
};

std::string table_of_checks(const nlohmann::json& checks) {
  constexpr std::size_t kName = 20;
  constexpr std::size_t kVerdict = 13;
  std::string text;
  const auto padded = [](std::string words, std::size_t width) {
    words.resize(std::max(words.size() + 1, width), ' ');
    return words;
  };
  for (const auto& check : checks) {
    const auto accepted = check.at("accepted").get<std::string>();
    std::string line = padded(check.at("check"), kName) + padded(check.at("verdict"), kVerdict);
    line += check.at("measured").get<std::string>();
    if (!accepted.empty()) line += " (accepted: " + accepted + ")";
    text += text::wrapped(line, kName + kVerdict) + '\n';
  }
  return text;
}

void run_check_device(const CheckDeviceOptions& options) {
  if (options.request.guided && (::isatty(STDIN_FILENO) == 0 || ::isatty(STDERR_FILENO) == 0)) {
    throw std::invalid_argument("--guided asks a person at a terminal; standard input and error must be one");
  }
  results::prepare({.files = {options.json}});
  const nlohmann::json found = check_in_process(options.request);
  std::fputs(table_of_checks(found).c_str(), stdout);
  if (!options.json.empty()) text::write_file(options.json, found.dump(2) + '\n');
  const auto failed = std::ranges::count_if(found, [](const auto& check) { return check.at("verdict") == "failed"; });
  if (failed == 0) return;
  throw std::runtime_error("device '" + options.request.device + "' failed " + std::to_string(failed) + " of " +
                           std::to_string(found.size()) + " checks");
}

}  // namespace

void add_check_device(CLI::App& app) {
  auto options = std::make_shared<CheckDeviceOptions>();
  CheckDeviceRequest& request = options->request;
  CLI::App* command = app.add_subcommand("check-device", "Check a device and its driver, by moving it");
  command->add_option("--device", request.device, "device to check, with the settings of its driver")
      ->required()
      ->type_name("NAME[:KEY=VALUE,...]");
  command->add_option("--force-share", request.force_share, "largest force, as a share of the device's largest")
      ->type_name("SHARE")
      ->check(program::number_within(0.01, 1))
      ->capture_default_str();
  command->add_option("--speed", request.speed_m_per_s_max, "fastest motion of the tip that is pushed, in m/s")
      ->type_name("M_PER_S")
      ->check(program::number_within(0.01, 5))
      ->capture_default_str();
  command->add_flag("--guided", request.guided, "ask for unplugging, plugging in and buttons as well; at a terminal");
  program::add_output(*command, "--json", options->json, "write the checks to this file as well")
      ->type_name("FILE.json");
  command->footer(
      "THE DEVICE MOVES. Let nobody touch it, and leave room for 10 cm of motion along each axis. Each axis is pushed "
      "by a force that grows over 0.3 s, until it has moved 5 mm. A tip that is faster than --speed has no more force, "
      "and the check fails. Ctrl-C ends the force. With --force-share 1 it is also asked for more than its largest "
      "force, for 30 ms.\n"
      "\n"
      "Checks readings, their rate, times and jitter, rest at zero force, signs, axes and units, forces that are no "
      "numbers, the hold time, stop and start, unknown settings, reasons of failures, and that no call blocks. With "
      "--guided a person has a minute for each of: unplugging the device, plugging it in, pressing its buttons.\n"
      "\n"
      "All of it runs in a process of its own. Where a driver crashes, or a call takes longer than the hold time, "
      "at most 0.1 s, a watchdog stops the device; if the call does not return, that process ends. The checks "
      "made until then and the call are told.\n"
      "\n"
      "Ends with 0 if no check failed, with 1 if one did.\n"
      "\n"
      "Examples:\n"
      "  forcebound check-device --device omni\n"
      "  FORCEBOUND_DEVICE_PATH=. forcebound check-device --device pen --json checks.json\n"
      "  FORCEBOUND_DEVICE_PATH=. forcebound check-device --device pen --guided");
  command->callback([options] { run_check_device(*options); });
}

}  // namespace forcebound::client::commands
