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
  std::string robot{};  ///< name, `driver:FILE.so...` or a robot's file; empty: there is none, but scenes
  std::string task{};   ///< name or file, of a simulated robot
  FollowerSettings settings{};

  [[nodiscard]] bool any() const noexcept { return !robot.empty(); }
};

void add_follower_options(CLI::App& app, FollowerOptions& options, const control::LawRegistry& laws);

/// @throws std::invalid_argument where a simulated robot has no task, or one behind a driver has some
void expect_task(const FollowerOptions& options);

/// The laws that can bound a robot's torques: those that need nothing from elsewhere.
[[nodiscard]] std::vector<std::string> follower_laws(const control::LawRegistry& laws);

}  // namespace forcebound::server
