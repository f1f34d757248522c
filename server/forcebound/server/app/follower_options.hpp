#pragma once

#include <string>
#include <vector>

#include "forcebound/control/law_registry.hpp"
#include "forcebound/server/follower/follower.hpp"

namespace CLI {
class App;
}  // namespace CLI

namespace forcebound::server {

/// The command line's options on a robot that follows its clients.
struct FollowerOptions {
  std::string robot{};  ///< name; empty: there is none, but scenes
  std::string task{};   ///< name or file
  FollowerSettings settings{};

  [[nodiscard]] bool any() const noexcept { return !robot.empty(); }
};

void add_follower_options(CLI::App& app, FollowerOptions& options, const control::LawRegistry& laws);

/// Robots, tasks and architectures, for the help.
[[nodiscard]] std::string follower_help();

/// The laws that can bound a robot's torques: those that need nothing from elsewhere.
[[nodiscard]] std::vector<std::string> follower_laws(const control::LawRegistry& laws);

}  // namespace forcebound::server
