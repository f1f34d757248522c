#pragma once

#include <cstdint>

namespace forcebound::test {

/// False under sanitizers, which bring a malloc of their own: skip then, visibly.
bool allocations_are_counted() noexcept;

/// Heap allocations of this thread so far, by malloc and all that rests on it, `operator new` included.
std::uint64_t allocations() noexcept;

}  // namespace forcebound::test
