#pragma once

#include <cstdint>

namespace forcebound::time {

/// Heap operations (malloc, free and their kin, hence new and delete) of the calling thread since it began: how a
/// program and its tests see that the tick makes none.
///
/// A program that calls this gets a `malloc` that counts before it hands on to glibc's; one that does not is left
/// alone. Under a sanitizer, which has a `malloc` of its own, nothing is counted and `kCountsHeapOperations` is false.
///
/// Real time: noexcept, a thread-local read.
[[nodiscard]] std::uint64_t heap_operations_of_this_thread() noexcept;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kCountsHeapOperations = false;
#else
inline constexpr bool kCountsHeapOperations = true;
#endif

}  // namespace forcebound::time
