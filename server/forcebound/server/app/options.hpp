#pragma once

#include <optional>
#include <string>

#include "forcebound/net/endpoint.hpp"
#include "forcebound/server/environment/stability.hpp"
#include "forcebound/server/session/server.hpp"

namespace forcebound::server {

/// What the command line asked for.
struct ProgramOptions {
  net::Endpoint listen{"127.0.0.1", 47800};
  std::string scene = "wall";  ///< name or file
  bool explain = false;        ///< print what would be simulated, and end
  bool suggest = false;        ///< print with which device and hand to feel it, and end
  bool schema = false;         ///< print what a scene file may have, and end
  bool calibrate = false;      ///< measure it too
  RingingDevice device{};      ///< for the margins that are explained
  std::string record;          ///< file; empty: no recording
  bool verbose = false;
  bool realtime = false;
  ServerOptions server;  ///< `scene` in it is not set yet
};

/// Reads the command line. Where that ends the program already (help, version, wrong use) it has printed why, and the
/// result is the exit code.
struct ParsedCommandLine {
  ProgramOptions options;
  std::optional<int> exit_code;
};
ParsedCommandLine parse_command_line(int argc, const char* const* argv);

}  // namespace forcebound::server
