#pragma once

#include <cstddef>

namespace forcebound::server {

/// What this program has allocated from the heap and not freed [byte]. Takes up to a millisecond. Where the C library
/// is not glibc, or a sanitizer replaces its allocator, 0.
[[nodiscard]] std::size_t memory_in_use() noexcept;

/// What the machine has [byte]; 0: not known.
[[nodiscard]] std::size_t memory_of_machine() noexcept;

}  // namespace forcebound::server
