#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "tests/lab/commands.hpp"

int main(int argc, char** argv) {
  CLI::App app{
      "Experiments with Forcebound: the same laws, client and server as on the network, here in virtual time."};
  app.name("forcebound-lab");
  app.set_version_flag("--version", "forcebound-lab " FORCEBOUND_VERSION);
  app.require_subcommand(0, 1);
  app.get_formatter()->column_width(34);
  forcebound::lab::add_replay(app);
  forcebound::lab::add_reproduce(app);
  forcebound::lab::add_report(app);
  forcebound::lab::add_table(app);
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) throw CLI::RequiredError("an experiment");
    return 0;
  } catch (const CLI::Success& asked) {
    return app.exit(asked);
  } catch (const CLI::Error& wrong_use) {
    std::cerr << "forcebound-lab: " << wrong_use.what() << " (see forcebound-lab --help)\n";
    return 2;
  } catch (const std::exception& failure) {
    std::cerr << "forcebound-lab: " << failure.what() << '\n';
    return 1;
  }
}
