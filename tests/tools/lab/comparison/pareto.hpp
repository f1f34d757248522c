#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace forcebound::lab {

/// A law in the plane of a quantity to minimise and one to maximise.
struct Trade {
  double less;
  double more;
};

/// Those not dominated by another, in the order given. NaN is dominated.
[[nodiscard]] std::vector<std::size_t> pareto_front(std::span<const Trade> trades);

}  // namespace forcebound::lab
