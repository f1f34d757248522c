#pragma once

#include <string>

#include "forcebound/client/app/options.hpp"
#include "forcebound/client/ros2/topics.hpp"
#include "forcebound/server/security/key_files.hpp"

namespace forcebound::ros2 {

/// The command line of forcebound-ros2.
struct Options {
  client::Options client{};  ///< of the device here; not used where there is an address to listen at
  Topics::Settings topics{};
  double publish_Hz = 0;    ///< 0: each tick
  std::string listen{};     ///< where a client is served; empty: the device is here
  server::KeyFiles keys{};  ///< of that server
};

inline constexpr const char* kProgram = "forcebound-ros2";
inline constexpr const char* kProgramAndVersion = "forcebound-ros2 " FORCEBOUND_VERSION;

/// Parses and completes the options.
/// @throws program::End for help, version and wrong use; std::invalid_argument for wrong use.
Options parse_options(int argc, const char* const* argv);

}  // namespace forcebound::ros2
