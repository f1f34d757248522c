#pragma once

#include <functional>
#include <string>

#include "forcebound/driver/driver_request.hpp"

namespace forcebound::driver {

/// Opens the device of a driver in a child process first, so that a driver that crashes or never returns ends that one
/// alone. What it refuses, this process is told when it asks itself. A crash that comes later is caught from then on
/// (catch_crashes).
/// @param file of the driver @param open opens it, and may throw
/// @throws std::runtime_error in one line, if it crashes or does not end
void expect_to_survive(const std::string& file, const DriverRequest& request, const std::function<void()>& open);

}  // namespace forcebound::driver
