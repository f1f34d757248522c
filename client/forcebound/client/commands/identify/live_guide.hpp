#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

#include "forcebound/client/commands/identify/guide.hpp"
#include "forcebound/device/haptic_device.hpp"

namespace forcebound::client::commands::identify {

/// Runs a guide on a device in real time, on a real-time thread of its own where the system grants it, beside a
/// watchdog if the device is not simulated: it stops the device when no tick has run for its hold time. Returns when
/// the guide is done or `stop` is set; the force is zero then. The guide's work is done on the caller's thread.
/// @param progress called a few times a second on the caller's thread
/// @returns how often the watchdog stopped the device
/// @throws std::runtime_error what `start` of the device throws
std::uint64_t run_live(Guide& guide, device::HapticDevice& device, double period_s, const std::atomic<bool>& stop,
                       const std::function<void(double share, const std::string& doing)>& progress);

}  // namespace forcebound::client::commands::identify
