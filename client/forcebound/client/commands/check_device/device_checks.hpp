#pragma once

#include <vector>

#include "forcebound/client/commands/check_device/device_check.hpp"

namespace forcebound::client::commands {

/// Checks a device that nobody touches: reads it, pushes it along each axis by a few millimetres, and lets it go; then,
/// if there is a person, while that one unplugs it, plugs it in and presses its buttons.
///
/// The force grows over 0.3 s to its share of the largest one, and ends when the device has moved 5 mm. Nothing is
/// pushed any more once the device does not go where it is pushed or is faster than it may be. Ends with `stop`,
/// whatever happens.
///
/// @throws std::runtime_error if it was cancelled, or if the device does not start.
[[nodiscard]] std::vector<DeviceCheck> check_device(device::HapticDevice& device, Pace& pace,
                                                    const DeviceCheckSettings& settings);

}  // namespace forcebound::client::commands
