// In place of teleoperate_command.cpp, and of all that it uses, in a build with FORCEBOUND_ROBOT=OFF.
#include <CLI/CLI.hpp>

#include <stdexcept>

#include "forcebound/program/without_robots.hpp"
#include "tests/tools/lab/commands.hpp"

namespace forcebound::lab {

void add_teleoperate(CLI::App& app) {
  app.add_subcommand("teleoperate", std::string("Not here: ") + program::kWithoutRobots)->allow_extras()->callback([] {
    throw std::invalid_argument(program::kWithoutRobots);
  });
}

}  // namespace forcebound::lab
