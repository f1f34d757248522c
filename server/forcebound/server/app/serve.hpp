#pragma once

#include "forcebound/server/app/options.hpp"

namespace forcebound::server {

/// Serves until SIGINT or SIGTERM, then says goodbye to all clients and prints the totals.
///
/// @throws std::runtime_error if the scene or the address cannot be had
void serve(ProgramOptions options);

}  // namespace forcebound::server
