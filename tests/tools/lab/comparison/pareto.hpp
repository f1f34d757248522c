#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace forcebound::lab {

/// A law in the plane of what one wants less of and what one wants more of.
struct Trade {
  double less;
  double more;
};

/// Those that no other beats in one and equals in the other, in the order given. What is not a number is beaten.
[[nodiscard]] std::vector<std::size_t> pareto_front(std::span<const Trade> trades);

}  // namespace forcebound::lab
