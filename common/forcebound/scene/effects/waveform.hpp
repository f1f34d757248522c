#pragma once

#include <string_view>
#include <vector>

namespace forcebound::scene {

/// A periodic function of time between -1 and 1.
enum class Waveform : unsigned char { sine, square, triangle, sawtooth };

/// The names in scene files: sine, square, triangle, sawtooth.
const std::vector<std::string_view>& waveform_names();

/// @throws std::invalid_argument for another name.
Waveform waveform_from(std::string_view name);

/// At `turns` periods since its start, any finite number. All start at 0 and rise, but for the square, which starts at
/// 1. Real time: noexcept.
double value_of(Waveform waveform, double turns) noexcept;

/// Half of the motions' rate of 1 kHz: higher frequencies alias.
inline constexpr double kFrequency_Hz_most = 500;

}  // namespace forcebound::scene
