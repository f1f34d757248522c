// In place of with_robot.cpp, and of all that it uses, in a build with FORCEBOUND_ROBOT=OFF.
#include <CLI/CLI.hpp>

#include <stdexcept>
#include <string>

#include "forcebound/program/without_robots.hpp"
#include "forcebound/server/app/led_robot.hpp"

namespace forcebound::server {

void add_robot_options(CLI::App& app, StartRobot& /*start*/, const control::LawRegistry& /*laws*/) {
  for (const char* const name : {"--follower", "--task", "--architecture", "--follower-law", "--motion-scale",
                                 "--force-scale", "--approach-speed"}) {
    // The help shows none of them, and CLI11 does not name what it does not show.
    const auto refuse = [name](const std::string& /*asked*/) -> std::string {
      throw std::invalid_argument(std::string(name) + ": " + program::kWithoutRobots);
    };
    app.add_option(name)->check(refuse)->group("");
  }
}

std::string robot_help() { return std::string("Robots (--follower): ") + program::kWithoutRobots + ".\n"; }

}  // namespace forcebound::server
