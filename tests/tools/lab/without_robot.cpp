// In place of teleoperate_command.cpp, and of all that it uses, in a build with FORCEBOUND_ROBOT=OFF.
#include <CLI/CLI.hpp>

#include <stdexcept>

#include "tests/tools/lab/commands.hpp"

namespace forcebound::lab {
namespace {

constexpr const char* kRefusal = "this program was built without robots; -DFORCEBOUND_ROBOT=ON builds it with them";

}  // namespace

void add_teleoperate(CLI::App& app) {
  app.add_subcommand("teleoperate", std::string("Not here: ") + kRefusal)->allow_extras()->callback([] {
    throw std::invalid_argument(kRefusal);
  });
}

}  // namespace forcebound::lab
