#pragma once

#include <cstddef>
#include <functional>

namespace forcebound::lab {

struct CapacitySearch {
  std::size_t first = 8;     ///< tried first, then doubled
  std::size_t limit = 4096;  ///< never more
  double resolution = 0.03;  ///< of the answer, relative
  int attempts = 3;          ///< a number holds if one of these attempts succeeds: noise only makes results worse
};

/// The most clients that hold, by doubling and halving; 0 if not even one does. As robust as the machine's noise
/// allows: a failed number gets further attempts, and the number that bounded the search is tried again at its end.
///
/// @param holds tries that number of clients once
[[nodiscard]] std::size_t most_that_hold(const CapacitySearch& search, const std::function<bool(std::size_t)>& holds);

}  // namespace forcebound::lab
