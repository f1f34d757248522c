#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <string>
#include <utility>

#include "forcebound/text/terminal.hpp"
#include "tests/tools/lab/commands.hpp"

int main(int argc, char** argv) {
  CLI::App app{
      "Experiments with Forcebound: the same laws, client and server as on the network,\n"
      "here in virtual time.\n"};
  app.name("forcebound-lab");
  app.set_version_flag("--version", "forcebound-lab " FORCEBOUND_VERSION);
  app.require_subcommand(0, 1);
  app.formatter_fn([](const CLI::App* of, std::string name, CLI::AppFormatMode mode) {
    CLI::Formatter formatter;
    formatter.column_width(34);
    return forcebound::text::wrapped_help(formatter.make_help(of, std::move(name), mode));
  });
  app.footer(
      "Each command has its own --help: forcebound-lab replay --help\n\n"
      "Examples:\n"
      "  forcebound-lab trials sphere --netem \"delay 50ms 10ms loss 5%\"\n"
      "      each law on the sphere through that network, figures that repeat\n"
      "  forcebound-lab reproduce sphere --figures out\n"
      "      the paper's sphere, in a few seconds\n"
      "  forcebound-lab report run.mcap --figures out\n"
      "      summary and figures of a client's recording\n"
      "  forcebound-lab passivity --figure leaks.png\n"
      "      energy that each law leaks on a real device, and the cost of the guarantee\n"
      "  forcebound-lab soak --seeds 1000\n"
      "      hostile runs, each from its seed, checked on every tick\n"
      "  forcebound-lab accuracy palpation --rtt 1,20\n"
      "      cost of a finer tissue, and its error at the device\n"
      "  forcebound-lab compare --scenes wall --network \"delay 10ms\"\n"
      "      all laws side by side\n"
      "  forcebound-lab load --server 127.0.0.1:47800 --clients 20\n"
      "      20 clients at 1 kHz, over real sockets\n"
      "  forcebound-lab table a.json b.mcap\n"
      "      runs side by side\n\n"
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
  forcebound::lab::add_trials(app);
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) throw CLI::RequiredError("an experiment");
    return 0;
  } catch (const CLI::Success& asked) {
    return app.exit(asked);
  } catch (const CLI::Error& wrong_use) {
    // A mistyped option explains why another is missing, so it is reported first.
    const auto unknown = app.remaining(true);
    const std::string what = unknown.empty() ? wrong_use.what() : CLI::ExtrasError(unknown).what();
    std::cerr << "forcebound-lab: " << what << " (see forcebound-lab --help)\n";
    return 2;
  } catch (const std::exception& failure) {
    std::cerr << "forcebound-lab: " << failure.what() << '\n';
    return 1;
  }
}
