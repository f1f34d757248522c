#pragma once

#include <atomic>

#include "forcebound/client/app/options.hpp"

namespace forcebound::client {

/// Runs the client until its time is up or `stop` is set, prints the summary on stdout and writes what was asked for.
/// @returns the exit code. @throws std::exception with one line for a person if it cannot even begin.
int run(const Options& options, const std::atomic<bool>& stop);

}  // namespace forcebound::client
