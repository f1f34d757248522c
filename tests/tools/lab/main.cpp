#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <string>

#include "tests/tools/lab/commands.hpp"

int main(int argc, char** argv) {
  CLI::App app{
      "Experiments with Forcebound: the same laws, client and server as on the network, here in virtual time.\n"};
  app.name("forcebound-lab");
  app.set_version_flag("--version", "forcebound-lab " FORCEBOUND_VERSION);
  app.require_subcommand(0, 1);
  app.get_formatter()->column_width(34);
  app.footer(
      "Each has its own --help: forcebound-lab replay --help\n\n"
      "Examples:\n"
      "  forcebound-lab reproduce sphere --figures out   the paper's sphere, in a few seconds\n"
      "  forcebound-lab report run.mcap --figures out    what a client recorded with --record run.mcap\n"
      "  forcebound-lab passivity --figure leaks.png     what each law leaks on a real device, and what that costs\n"
      "  forcebound-lab soak --seeds 1000                hostile runs, each from its seed, checked on every tick\n"
      "  forcebound-lab accuracy palpation --rtt 1,20    what a finer tissue costs, and what is left of it at the "
      "device\n"
      "  forcebound-lab compare --scenes wall --network \"delay 10ms\"   all laws side by side\n"
      "  forcebound-lab load --server 127.0.0.1:47800 --clients 20   20 clients at 1 kHz, over real sockets\n"
      "  forcebound-lab table a.json b.mcap              runs side by side\n\n"
      "Exit code: 0 done, 1 failed, 2 wrong use.");
  forcebound::lab::add_accuracy(app);
  forcebound::lab::add_bench(app);
  forcebound::lab::add_compare(app);
  forcebound::lab::add_load(app);
  forcebound::lab::add_replay(app);
  forcebound::lab::add_reproduce(app);
  forcebound::lab::add_passivity(app);
  forcebound::lab::add_report(app);
  forcebound::lab::add_soak(app);
  forcebound::lab::add_table(app);
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) throw CLI::RequiredError("an experiment");
    return 0;
  } catch (const CLI::Success& asked) {
    return app.exit(asked);
  } catch (const CLI::Error& wrong_use) {
    // A mistyped option explains why another is missing, so it comes first.
    const auto unknown = app.remaining(true);
    const std::string what = unknown.empty() ? wrong_use.what() : CLI::ExtrasError(unknown).what();
    std::cerr << "forcebound-lab: " << what << " (see forcebound-lab --help)\n";
    return 2;
  } catch (const std::exception& failure) {
    std::cerr << "forcebound-lab: " << failure.what() << '\n';
    return 1;
  }
}
