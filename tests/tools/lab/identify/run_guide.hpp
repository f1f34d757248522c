#pragma once

#include <cstdint>

#include "forcebound/device/haptic_device.hpp"
#include "tests/tools/lab/identify/guide.hpp"

namespace forcebound::lab::identify {

/// Runs a guide on a device in virtual time, to its end: a tick each period, not to the nanosecond, as a computer's is.
/// @param seconds_max virtual; where it is longer, something is wrong: the guide is left as it is
void run_in_virtual_time(Guide& guide, device::HapticDevice& device, double period_s, std::uint64_t seed,
                         double seconds_max = 3600);

}  // namespace forcebound::lab::identify
