#include <unistd.h>
#include <CLI/CLI.hpp>

#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/program/command_line.hpp"
#include "forcebound/program/output_options.hpp"
#include "forcebound/results/draw.hpp"
#include "forcebound/results/outputs.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/table.hpp"
#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/figures/figure_scripts.hpp"
#include "tests/tools/lab/fleet/fleet_simulation.hpp"

namespace forcebound::lab {
namespace {

constexpr double kMilli = 1e3;
constexpr double kMicro = 1e6;
constexpr double kHertz = 1000;

struct FleetOptions {
  FleetSettings settings;
  double clients_of_core = 140;  ///< at 1 kHz
  double handshake_ms = 0.28;
  double allocate_ms = 2;
  std::string csv;
  std::string figure;
  std::vector<std::string> formats;
};

std::string assumptions(const FleetSettings& settings, double clients_of_core) {
  const auto number = [](double value) { return text::rounded(value); };
  std::string words = "Assumed: " + std::to_string(settings.clients) + " clients arrive at random within " +
                      number(settings.arrive_s) + " s, stay " + number(settings.stay_s) +
                      " s on average and change their address every " + number(settings.roam_s) +
                      " s; each sends 1000 motions a second. A server has a core and " +
                      std::to_string(settings.places) + " places; " + std::to_string(settings.servers_of_node) +
                      " are on a node. A fleet that looks every " + number(settings.look_s) + " s keeps " +
                      std::to_string(settings.spares) + " servers that wait, each started in " +
                      number(settings.start_s) + " s. The allocator takes " + number(settings.allocate_s * kMilli) +
                      " ms for a client, one after the other. The node with most sessions fails at";
  for (const double at_s : settings.failures_s) words += " " + number(at_s);
  words += " s; its clients notice after " + number(settings.notice_s) + " s and up to " + number(settings.spread_s) +
           " s more. Seed " + std::to_string(settings.seed) + ".\n\n";
  return words + "Measured: a core answers " + number(clients_of_core) + " encrypted clients, " +
         number(settings.motion_s * kMicro) + " us a motion; a handshake takes it " +
         number(settings.handshake_s * kMilli) + " ms.";
}

std::string milliseconds(double seconds) { return std::isfinite(seconds) ? text::rounded(seconds * kMilli) : "-"; }

text::Table table_of(const FleetResult& result) {
  text::Table table({{"what"}, {"median", "ms"}, {"99 %", "ms"}, {"99.9 %", "ms"}, {"longest", "ms"}, {"times"}});
  const auto add = [&](const std::string& what, const std::vector<double>& values) {
    table.add({what, milliseconds(at_share(values, 0.5)), milliseconds(at_share(values, 0.99)),
               milliseconds(at_share(values, 0.999)), milliseconds(at_share(values, 1)),
               std::to_string(values.size())});
  };
  add("arrival until the session", result.waits_s);
  add("failure until the session", result.outages_s);
  add("a handshake, until answered", result.handshakes_s);
  return table;
}

std::string words_of(const FleetResult& result, const FleetSettings& settings) {
  const double load = static_cast<double>(result.sessions_of_server_most) * kHertz * settings.motion_s;
  return std::to_string(result.arrived) + " arrived, " + std::to_string(result.sessions_most) +
         " at once at most, on " + std::to_string(result.servers_most) + " servers; " + std::to_string(result.roamed) +
         " changes of address. " + std::to_string(result.failed_over) +
         " lost their node: " + std::to_string(result.back) + " came back, " + std::to_string(result.left_meanwhile) +
         " had been about to leave. The allocator had no server " + std::to_string(result.refused) +
         " times. The fullest server had " + std::to_string(result.sessions_of_server_most) + " sessions, " +
         text::rounded(100 * load) + " % of its core: a motion waits " +
         text::rounded(mean_wait_s(load, settings.motion_s) * kMicro) + " us for others on average.";
}

void run(FleetOptions options) {
  FleetSettings& settings = options.settings;
  settings.motion_s = 1 / (kHertz * options.clients_of_core);
  settings.handshake_s = options.handshake_ms / kMilli;
  settings.allocate_s = options.allocate_ms / kMilli;
  results::prepare({.files = {options.csv}, .figures = {options.figure}, .formats = options.formats});
  const FleetResult result = simulate_fleet(settings);
  std::cout << text::wrapped(assumptions(settings, options.clients_of_core), 0) << "\n"
            << table_of(result).to_text(text::colour_for(STDOUT_FILENO)) << "\n"
            << text::wrapped(words_of(result, settings), 0) << "\n";
  if (!options.csv.empty()) text::write_file(options.csv, fleet_csv(result));
  if (!options.figure.empty())
    results::draw({.script = text::text_of(figure_scripts(), "fleet"), .csv = fleet_csv(result)}, options.figure,
                  options.formats);
}

void add_demand(CLI::App& command, FleetOptions& options) {
  const auto seconds = [&](const char* name, double& value, double least, const char* what) {
    command.add_option(name, value, what)
        ->check(program::number_within(least, 1e6))
        ->type_name("SECONDS")
        ->capture_default_str();
  };
  FleetSettings& settings = options.settings;
  command.add_option("--clients", settings.clients, "clients that arrive")
      ->check(program::whole_within(1, 10'000'000))
      ->type_name("N")
      ->capture_default_str();
  seconds("--arrive", settings.arrive_s, 1, "time within which they arrive");
  seconds("--stay", settings.stay_s, 1, "mean length of a session");
  seconds("--roam", settings.roam_s, 0, "mean time between changes of a client's address; 0: never");
  command.add_option("--fail-at", settings.failures_s, "times at which the node with most sessions fails")
      ->check(program::number_within(0, 1e6))
      ->type_name("SECONDS")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  seconds("--notice", settings.notice_s, 0, "until a client notices that its server is gone");
  seconds("--spread", settings.spread_s, 0, "up to so much longer, at random, it waits before it asks for another");
}

void add_supply(CLI::App& command, FleetOptions& options) {
  FleetSettings& settings = options.settings;
  const auto whole = [&](const char* name, std::size_t& value, const char* what) {
    command.add_option(name, value, what)
        ->check(program::whole_within(1, 1'000'000))
        ->type_name("N")
        ->capture_default_str();
  };
  whole("--places", settings.places, "sessions of a server at most");
  whole("--servers-of-node", settings.servers_of_node, "servers that fail together");
  whole("--servers-most", settings.servers_most, "servers at most");
  whole("--spares", settings.spares, "servers that wait for clients");
  command.add_option("--look", settings.look_s, "from one look of the fleet at its spares to the next")
      ->check(program::number_within(0.1, 3600))
      ->type_name("SECONDS")
      ->capture_default_str();
  command.add_option("--start", settings.start_s, "until a new server serves")
      ->check(program::number_within(0, 3600))
      ->type_name("SECONDS")
      ->capture_default_str();
  command.add_option("--clients-of-core", options.clients_of_core, "encrypted clients at 1 kHz that a core answers")
      ->check(program::number_within(1, 1e6))
      ->type_name("N")
      ->capture_default_str();
  command.add_option("--handshake", options.handshake_ms, "time of the server for a handshake")
      ->check(program::number_within(0, 1000))
      ->type_name("MS")
      ->capture_default_str();
  command.add_option("--allocate", options.allocate_ms, "time of the allocator for a request")
      ->check(program::number_within(0, 1000))
      ->type_name("MS")
      ->capture_default_str();
}

}  // namespace

void add_fleet(CLI::App& app) {
  auto options = std::make_shared<FleetOptions>();
  CLI::App* command = app.add_subcommand("fleet",
                                         "Clients that arrive at a fleet of servers, change their addresses and fail "
                                         "over, in virtual time: waits, outages "
                                         "and servers needed, from measured costs");
  add_demand(*command, *options);
  add_supply(*command, *options);
  command->add_option("--seed", options->settings.seed, "of all that is random")
      ->check(program::whole_within(0))
      ->type_name("N")
      ->capture_default_str();
  program::add_output(*command, "--csv", options->csv, "write each second to this file")->type_name("FILE.csv");
  program::add_figure(*command, options->figure, options->formats,
                      "draw sessions, servers and waiting clients over time");
  command->footer(
      "What a motion and a handshake cost was measured by deploy/bench and security_benchmark; see "
      "deploy/CAPACITY.md.\n"
      "\n"
      "Example:\n  forcebound-lab fleet --fail-at 1200,1500 --spread 2 --figure fleet.png");
  command->callback([options] { run(*options); });
}

}  // namespace forcebound::lab
