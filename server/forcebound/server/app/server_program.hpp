#pragma once

namespace forcebound::server {

/// forcebound-server: reads the command line, then serves, explains or describes. @returns the exit code
int run_program(int argc, const char* const* argv);

}  // namespace forcebound::server
