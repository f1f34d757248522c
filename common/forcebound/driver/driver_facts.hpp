#pragma once

#include <string>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/device/safety.hpp"
#include "forcebound/driver/forcebound_device.h"

namespace forcebound::driver {

/// What a driver says of its device, as the laws read it.
/// @throws std::runtime_error in one line, beginning with the driver's name: what is missing or cannot be
[[nodiscard]] control::DeviceFacts facts_of(const forcebound_facts& told, const std::string& driver);

/// Limits for a person's hand on that device: as for any, but the heat's is the force that its motors may give for
/// ever, if the driver knows it.
/// @throws as above
[[nodiscard]] device::Safety safety_of(const forcebound_facts& told, const control::DeviceFacts& facts,
                                       const std::string& driver);

}  // namespace forcebound::driver
