#include "forcebound/client/runtime/zero_force_first.hpp"

#include <algorithm>
#include <cstdio>

namespace forcebound::client {

std::size_t ZeroForceFirst::describe(std::span<char> words) const noexcept {
  const int length = std::snprintf(words.data(), words.size(), "tick %llu, state %s, seed %llu",
                                   static_cast<unsigned long long>(session_.ticks()), name_of(session_.state()),
                                   static_cast<unsigned long long>(seed_));
  return std::min(static_cast<std::size_t>(std::max(length, 0)), words.size() - 1);
}

}  // namespace forcebound::client
