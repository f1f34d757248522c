#pragma once

#include <cmath>
#include <string>

#include "forcebound/text/numbers.hpp"

namespace forcebound::lab {

/// A share as text: "46 %". Rounding errors of sums are shown as 0.
[[nodiscard]] inline std::string percent(double share) {
  constexpr double kLeastShare = 1e-12;
  return text::rounded(std::abs(share) < kLeastShare ? 0 : 100 * share) + " %";
}

}  // namespace forcebound::lab
