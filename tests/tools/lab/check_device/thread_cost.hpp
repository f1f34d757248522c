#pragma once

#include <functional>

#include "tests/tools/lab/check_device/device_checks.hpp"

namespace forcebound::lab {

/// Runs `call`. @returns what it cost this thread, by the system's clocks
[[nodiscard]] CallCost thread_cost_of(const std::function<void()>& call);

}  // namespace forcebound::lab
