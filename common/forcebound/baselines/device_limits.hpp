#pragma once

#include <string_view>

#include "forcebound/control/device_facts.hpp"

/// Facts of a device from which the baseline laws choose their gains.
namespace forcebound::baselines {

/// The smallest damping in any direction [N s/m].
[[nodiscard]] double least_damping(const control::DeviceFacts& facts);

/// Half an encoder's step in a period [m/s]: a motion that shows in a reading is faster. 0 where the device has no
/// steps, or is an arm, whose steps at the tip depend on its pose.
[[nodiscard]] double slowest_reading_m_per_s(const control::DeviceFacts& facts);

/// @throws std::invalid_argument unless the device has one to three translations with constant damping: these laws have
/// one gain for all axes.
void require_constant_translations(std::string_view law, const control::DeviceFacts& facts);

/// @throws std::invalid_argument if the device shows torques: these laws compare lengths of forces or ways over all
/// axes.
void require_translations(std::string_view law, const control::DeviceFacts& facts);

}  // namespace forcebound::baselines
