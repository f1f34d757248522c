#pragma once

#include <atomic>

#include "forcebound/client/app/options.hpp"

namespace forcebound::client {

/// Runs the client until its time is up or `stop` is set, prints the summary on stdout and writes the requested files.
/// @returns the exit code. @throws std::exception with a message of one line if it cannot start.
int run(const Options& options, const std::atomic<bool>& stop);

}  // namespace forcebound::client
