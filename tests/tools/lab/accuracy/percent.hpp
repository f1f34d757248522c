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

/// Whether an error is larger than what the reference's uncertainty can bring about, three times of it.
[[nodiscard]] inline bool is_above(double share, double uncertainty) { return share >= 3 * uncertainty; }

/// The error, or the bound below which it lies: "<= 3 %".
[[nodiscard]] inline std::string percent_above(double share, double uncertainty) {
  return is_above(share, uncertainty) ? percent(share) : "<= " + percent(3 * uncertainty);
}

}  // namespace forcebound::lab
