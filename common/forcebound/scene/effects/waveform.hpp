#pragma once

#include <string_view>
#include <vector>

namespace forcebound::scene {

/// A function of time between -1 and 1 that repeats itself.
enum class Waveform : unsigned char { sine, square, triangle, sawtooth };

/// As scene files say it: sine, square, triangle, sawtooth.
const std::vector<std::string_view>& waveform_names();

/// @throws std::invalid_argument for another name.
Waveform waveform_from(std::string_view name);

/// At `turns` periods since its beginning, any finite number. All begin at 0 and rise, but for the square, which begins
/// at 1. Real time: noexcept.
double value_of(Waveform waveform, double turns) noexcept;

/// The most that motions a millisecond apart can carry.
inline constexpr double kFrequency_Hz_most = 500;

}  // namespace forcebound::scene
