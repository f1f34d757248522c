#include <CLI/CLI.hpp>
#include <span>
#include <stdexcept>
#include <string>

#include "forcebound/client/commands/commands.hpp"
#include "forcebound/client/commands/programs.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/program/exit_codes.hpp"

namespace {

namespace commands = forcebound::client::commands;

constexpr const char* kName = "forcebound";

int run(int argc, char** argv) {
  const std::span words(argv, static_cast<std::size_t>(argc) + 1);
  if (argc > 1 && commands::is_program(words[1])) commands::become_program(words.subspan(1));
  CLI::App app;
  forcebound::program::set_up(app, kName);
  app.description("Networked haptics that stays passive: the tools of every day, and the programs themselves.\n");
  app.require_subcommand(0, 1);
  for (const commands::Program& program : commands::kPrograms) {
    app.add_subcommand(std::string(program.command), std::string(program.about));
  }
  commands::add_check_device(app);
  commands::add_doctor(app);
  commands::add_identify(app);
  commands::add_keygen(app);
  commands::add_replay(app);
  commands::add_report(app);
  commands::add_table(app);
  commands::add_view(app);
  // Not above: subcommands would print it too.
  app.footer(
      "Each command has its own --help: forcebound report --help\n"
      "\n"
      "Examples:\n"
      "  forcebound server --scene dome\n"
      "      a scene to be felt\n"
      "  forcebound client --server 127.0.0.1:47800 --scene dome --page\n"
      "      feel it with the mouse, in a browser\n"
      "  forcebound doctor --server 127.0.0.1:47800\n"
      "      what the way to that server and this machine will feel like\n"
      "  forcebound report run.mcap --figures out\n"
      "      summary and figures of a client's recording\n"
      "  forcebound view run.mcap\n"
      "      the same run in a browser, played again\n"
      "  forcebound table a.json b.mcap\n"
      "      runs side by side\n"
      "  forcebound identify --device NAME --out facts.toml\n"
      "      damping, friction, latency and hold time of a device, by moving it\n"
      "  forcebound keygen server.key\n"
      "      a new key of a server, or of a client\n"
      "\n" +
      forcebound::program::exit_codes_without(
          {forcebound::program::kNotPassive, forcebound::program::kNeverConnected}));
  forcebound::program::parse(app, argc, argv);
  if (app.get_subcommands().empty()) throw std::invalid_argument("a command is required");
  return forcebound::program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return forcebound::program::run(kName, [&] { return run(argc, argv); });
}
