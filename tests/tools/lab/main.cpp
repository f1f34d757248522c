#include <CLI/CLI.hpp>

#include "forcebound/program/command_line.hpp"
#include "forcebound/program/exit_codes.hpp"
#include "tests/tools/lab/commands.hpp"
#include "tests/tools/lab/trials/trials.hpp"

namespace {

constexpr const char* kName = "forcebound-lab";

int run(int argc, const char* const* argv) {
  CLI::App app;
  forcebound::program::set_up(app, kName);
  app.description(
      "Experiments with Forcebound: the same laws, client and server as on the network, here in virtual time.\n");
  app.require_subcommand(0, 1);
  forcebound::lab::add_accuracy(app);
  forcebound::lab::add_bench(app);
  forcebound::lab::add_compare(app);
  forcebound::lab::add_fleet(app);
  forcebound::lab::add_identification(app);
  forcebound::lab::add_load(app);
  forcebound::lab::add_passivity(app);
  forcebound::lab::add_rates(app);
  forcebound::lab::add_rendering(app);
  forcebound::lab::add_reproduce(app);
  forcebound::lab::add_soak(app);
  forcebound::lab::add_teleoperate(app);
  forcebound::lab::add_trials(app);
  forcebound::lab::add_violations(app);
  // Not above: subcommands would print it too.
  app.footer(
      "Each command has its own --help: forcebound-lab trials --help\n"
      "\n"
      "Examples:\n"
      "  forcebound-lab trials dome --netem \"delay 50ms 10ms loss 5%\"\n"
      "      remote and local rendering of the dome through that network, figures that repeat\n"
      "  forcebound-lab reproduce sphere --figures out\n"
      "      the paper's sphere, in a few seconds\n"
      "  forcebound-lab passivity --figure leaks.png\n"
      "      energy that each law leaks on a real device, and the cost of the guarantee\n"
      "  forcebound-lab soak --seeds 1000\n"
      "      hostile runs, each from its seed, checked on every tick\n"
      "  forcebound-lab accuracy palpation --rtt 1,20\n"
      "      cost of a finer tissue, and its error at the device\n"
      "  forcebound-lab compare --scenes wall --network \"delay 10ms\"\n"
      "      all laws side by side\n"
      "  forcebound-lab rendering --only mesh\n"
      "      a mesh rendered at the server and at the client, through 20 to 200 ms\n"
      "  forcebound-lab identification --devices 100\n"
      "      how close `forcebound identify` comes to the truth of simulated devices\n"
      "  forcebound-lab fleet --fail-at 1200,1500\n"
      "      100,000 clients at a fleet of servers of which two nodes fail\n"
      "  forcebound-lab load --server 127.0.0.1:47800 --clients 20\n"
      "      20 clients at 1 kHz, over real sockets\n"
      "\n" +
      forcebound::program::exit_codes_without({forcebound::program::kNotPassive, forcebound::program::kNeverConnected,
                                               forcebound::program::kDriverCrashed}));
  forcebound::program::parse(app, argc, argv);
  if (app.get_subcommands().empty()) throw std::invalid_argument("a command is required");
  return forcebound::program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return forcebound::program::run(kName, [&] { return run(argc, argv); });
}
