#pragma once

#include <atomic>

#include "forcebound/client/app/options.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/device_registry.hpp"

namespace forcebound::client {

/// Runs with a live page, which outlives the clients. A choice on it ends the client, with zero force and its server
/// told, and begins another from where the tip is, so that a law begins with an empty ledger and a scene with a session
/// of its own. Each run has its own recording and summary, the second NAME-2.EXTENSION and so on.
/// @returns the exit code, of the last run. @throws std::exception with one line if it cannot start
int run_with_page(const Options& options, const control::LawRegistry& laws, const device::DeviceRegistry& devices,
                  const std::atomic<bool>& stop);

}  // namespace forcebound::client
