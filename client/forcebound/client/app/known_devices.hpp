#pragma once

#include "forcebound/device/device_registry.hpp"

namespace forcebound::client {

/// The simulated devices, and those behind drivers in the folders of FORCEBOUND_DEVICE_PATH and in the one where
/// drivers are installed beside this program.
[[nodiscard]] device::DeviceRegistry known_devices();

}  // namespace forcebound::client
