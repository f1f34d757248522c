#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace forcebound::time {

/// Ranks, from 1, of the two sorted values whose mean is a percentile.
struct PercentileRanks {
  std::uint64_t low = 1;
  std::uint64_t high = 1;  ///< equals `low`, except for the median of an even count
};

/// The nearest rank: the smallest value that at least `fraction` of all values do not exceed. The median of an even
/// count is the mean of the two in the middle, so that it does not depend on which of them is taken.
/// @param fraction 0 to 1
/// @param count > 0
[[nodiscard]] inline PercentileRanks percentile_ranks(double fraction, std::uint64_t count) noexcept {
  const double rank = std::ceil(fraction * static_cast<double>(count));
  const std::uint64_t low = std::clamp<std::uint64_t>(static_cast<std::uint64_t>(std::max(1.0, rank)), 1, count);
  return {low, fraction == 0.5 && count % 2 == 0 ? low + 1 : low};
}

/// The percentile of values, such as durations. Reorders them.
/// @param values not empty
[[nodiscard]] inline double percentile_of(std::vector<double>& values, double fraction) noexcept {
  const auto [low, high] = percentile_ranks(fraction, values.size());
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(low) - 1;
  std::nth_element(values.begin(), at, values.end());
  return high == low ? *at : 0.5 * (*at + *std::min_element(at + 1, values.end()));
}

}  // namespace forcebound::time
