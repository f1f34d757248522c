#pragma once

#include <cstdint>

#include "forcebound/client/commands/identify/guide.hpp"
#include "forcebound/device/haptic_device.hpp"

namespace forcebound::lab::identification {

/// Runs a guide on a device in virtual time, to its end: a tick each period, not to the nanosecond, as a computer's is.
/// @param seconds_max virtual; where it is longer, something is wrong: the guide is left as it is
void run_in_virtual_time(client::commands::identify::Guide& guide, device::HapticDevice& device, double period_s,
                         std::uint64_t seed, double seconds_max = 3600);

}  // namespace forcebound::lab::identification
