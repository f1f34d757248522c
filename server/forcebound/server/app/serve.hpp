#pragma once

#include "forcebound/server/app/options.hpp"

namespace forcebound::server {

/// Serves until SIGINT or SIGTERM, then ends all sessions and prints the totals.
///
/// @returns the exit code: program::kOutputLost if the recording is incomplete
/// @throws std::runtime_error if the scene or the address is not available
int serve(ProgramOptions options);

}  // namespace forcebound::server
