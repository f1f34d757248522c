#pragma once

#include <string>
#include <vector>

#include "forcebound/device/device_registry.hpp"

namespace forcebound::driver {

/// The devices of drivers in these folders, as `NAME[:KEY=VALUE,...]`.
///
/// A request is opened once: its facts are those of the device that `make` then gives away. Before this process opens
/// it, a child process does, so that a driver that crashes or never returns ends that one alone.
[[nodiscard]] device::DeviceFamily driver_family(std::vector<std::string> folders);

}  // namespace forcebound::driver
