#pragma once

namespace forcebound::client {

/// forcebound-client: reads the command line and runs until its time is up or a signal ends it. @returns the exit code
int run_program(int argc, const char* const* argv);

}  // namespace forcebound::client
