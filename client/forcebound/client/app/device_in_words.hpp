#pragma once

#include <string>
#include <string_view>

#include "forcebound/device/haptic_device.hpp"

namespace forcebound::client {

/// What the client's first line says of its device: simulated or not, and of one that is not, whether its bounds were
/// ever measured. @param hand the simulated one, by its name
[[nodiscard]] std::string first_words(const device::HapticDevice& device, const std::string& hand);

/// Logs what makes the units of a recorded hand's file doubtful, if anything. @param hand as for first_words
void warn_of_hand(const std::string& hand, const device::HapticDevice& device);

/// What a law guarantees with this device, to whom nobody audits it: nothing, while the device's bounds are guesses.
/// @param guarantee of the law, see LawRegistry::guarantee; empty: nothing
[[nodiscard]] std::string guarantee_with(const device::HapticDevice& device, const std::string& guarantee);

/// Why the client ends when a driver has crashed, or does not return from a call: Client::Lost.
[[nodiscard]] std::string lost_words(const device::HapticDevice& device, std::string_view crash, bool device_stopped,
                                     bool has_recording);

}  // namespace forcebound::client
