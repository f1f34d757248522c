#pragma once

#include <functional>

#include "forcebound/client/commands/check_device/device_checks.hpp"

namespace forcebound::client::commands {

/// Runs `call`. @returns what it cost this thread, by the system's clocks
[[nodiscard]] CallCost thread_cost_of(const std::function<void()>& call);

}  // namespace forcebound::client::commands
