#include <CLI/CLI.hpp>

#include "forcebound/client/commands/commands.hpp"
#include "forcebound/program/command_line.hpp"
#include "tests/tools/lab/trials/trials.hpp"

/// `demo report` is `forcebound report`, `demo trials` is `forcebound-lab trials`.
int main(int argc, char** argv) {
  constexpr const char* kName = "demo";
  return forcebound::program::run(kName, [&] {
    CLI::App app;
    forcebound::program::set_up(app, kName);
    app.require_subcommand(1);
    forcebound::client::commands::add_report(app);
    forcebound::lab::add_trials(app);
    forcebound::program::parse(app, argc, argv);
    return forcebound::program::kDone;
  });
}
