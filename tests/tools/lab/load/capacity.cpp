#include "tests/tools/lab/load/capacity.hpp"

#include <algorithm>

namespace forcebound::lab {
namespace {

constexpr int kDoubtsMax = 3;

}  // namespace

std::size_t most_that_hold(const CapacitySearch& search, const std::function<bool(std::size_t)>& holds) {
  const auto holds_once = [&](std::size_t clients) {
    for (int attempt = 0; attempt < search.attempts; ++attempt) {
      if (holds(clients)) return true;
    }
    return false;
  };
  std::size_t most = 0;
  std::size_t too_many = search.limit + 1;
  std::size_t next = std::clamp<std::size_t>(search.first, 1, search.limit);
  const auto close_enough = [&] {
    const auto step = static_cast<std::size_t>(search.resolution * static_cast<double>(most));
    return too_many - most <= std::max<std::size_t>(1, step);
  };
  for (int doubts = 0;;) {
    while (!close_enough()) {
      (holds_once(next) ? most : too_many) = next;
      // Doubles until a number fails, then bisects.
      next = too_many > search.limit ? std::min(2 * most, search.limit) : most + (too_many - most) / 2;
    }
    // A chance failure at a low number would have excluded all higher ones.
    if (too_many > search.limit || ++doubts > kDoubtsMax || !holds_once(too_many)) return most;
    most = too_many;
    too_many = search.limit + 1;
    next = std::min(2 * most, search.limit);
  }
}

}  // namespace forcebound::lab
