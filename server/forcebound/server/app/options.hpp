#pragma once

#include <optional>
#include <string>
#include <vector>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/page/listen_address.hpp"
#include "forcebound/server/app/fleet_member.hpp"
#include "forcebound/server/app/key_options.hpp"
#include "forcebound/server/app/led_robot.hpp"
#include "forcebound/server/environment/stability.hpp"
#include "forcebound/server/session/server_options.hpp"

namespace forcebound::server {

/// The command line's options.
struct ProgramOptions {
  net::Endpoint listen{"127.0.0.1", 47800};
  std::string scene = "wall";               ///< name or file
  StartRobot start_robot{};                 ///< a robot instead of the scene; empty: there is none
  std::vector<std::string> scene_files;     ///< folders in which files that it names may lie, besides its own
  bool explain = false;                     ///< print what would be simulated, and end
  bool suggest = false;                     ///< print a suitable device and hand, and end
  bool schema = false;                      ///< print every key of a scene file, and end
  bool calibrate = false;                   ///< measure its cost too
  RingingDevice device{};                   ///< for the stability margins
  std::string record;                       ///< file; empty: no recording
  std::optional<page::ListenAddress> page;  ///< where the live page is served; none: nowhere
  KeyFiles keys;
  bool verbose = false;
  bool realtime = false;
  std::size_t workers = 1;               ///< threads that serve, each with its own socket and sessions; 0: one for
                                         ///< each processor that the process may use
  Nanoseconds drain{0};                  ///< after SIGTERM it waits so long for clients to leave
  AfterUse after_use = AfterUse::ready;  ///< as a member of a fleet
  ServerOptions server;                  ///< `scene` in it is not set yet
};

inline constexpr const char* kProgram = "forcebound-server";

/// Reads the command line.
/// @throws program::End for help, version and wrong use; std::invalid_argument for wrong use.
ProgramOptions parse_command_line(int argc, const char* const* argv);

}  // namespace forcebound::server
