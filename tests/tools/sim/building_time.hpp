#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "forcebound/time/clock.hpp"

namespace forcebound::sim {

/// From when a client's thread beside the tick looks for work until it looks again: every 2 ms, and it is away as long
/// as it takes to build.
/// @param elements triangles and heights that it built, as SceneBuilder::work returns them
[[nodiscard]] constexpr time::Nanoseconds time_of_building(std::size_t elements) noexcept {
  constexpr time::Nanoseconds kPause = std::chrono::milliseconds{2};
  constexpr time::Nanoseconds kForEachElement = std::chrono::microseconds{3};
  return kPause + static_cast<std::int64_t>(elements) * kForEachElement;
}

}  // namespace forcebound::sim
