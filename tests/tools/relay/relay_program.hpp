#pragma once

namespace forcebound::relay {

/// forcebound-relay: reads the command line and relays until a signal. @returns the exit code
int run_program(int argc, const char* const* argv);

}  // namespace forcebound::relay
