#include "tests/tools/lab/comparison/pareto.hpp"

#include <algorithm>
#include <cmath>

namespace forcebound::lab {
namespace {

bool beats(const Trade& one, const Trade& other) {
  const bool nowhere_worse = one.less <= other.less && one.more >= other.more;
  return nowhere_worse && (one.less < other.less || one.more > other.more);
}

}  // namespace

std::vector<std::size_t> pareto_front(std::span<const Trade> trades) {
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < trades.size(); ++i) {
    if (!std::isfinite(trades[i].less) || !std::isfinite(trades[i].more)) continue;
    const bool beaten = std::ranges::any_of(trades, [&](const Trade& other) { return beats(other, trades[i]); });
    if (!beaten) front.push_back(i);
  }
  return front;
}

}  // namespace forcebound::lab
