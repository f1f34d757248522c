#pragma once

#include "forcebound/device/device_family.hpp"

namespace forcebound::device {

/// The shipped devices and any that a TOML file describes, simulated, and the hands that move them.
[[nodiscard]] DeviceFamily simulated_devices();

}  // namespace forcebound::device
