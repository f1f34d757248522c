#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace forcebound::lab {

/// The smallest value that at least `fraction` of all do not exceed. @throws std::runtime_error if there is none
[[nodiscard]] inline double percentile(std::vector<double> values, double fraction) {
  if (values.empty()) throw std::runtime_error("no values, so no percentile");
  const double rank = std::max(1.0, std::ceil(fraction * static_cast<double>(values.size())));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank) - 1;
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace forcebound::lab
