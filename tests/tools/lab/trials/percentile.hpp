#pragma once

#include <stdexcept>
#include <vector>

#include "forcebound/time/percentile.hpp"

namespace forcebound::lab {

/// As time::percentile_of. @throws std::runtime_error if there is no value
[[nodiscard]] inline double percentile(std::vector<double> values, double fraction) {
  if (values.empty()) throw std::runtime_error("no values, so no percentile");
  return time::percentile_of(values, fraction);
}

}  // namespace forcebound::lab
