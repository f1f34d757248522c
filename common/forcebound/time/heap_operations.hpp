#pragma once

#include <cstdint>

namespace forcebound::time {

/// Heap operations (malloc, free and similar, hence new and delete) of the calling thread since it began: shows a
/// program and its tests that the tick makes none.
///
/// A program that calls this is linked with a `malloc` that counts and then calls glibc's; other programs are
/// unchanged. Under a sanitizer, which has a `malloc` of its own, nothing is counted and `kCountsHeapOperations` is
/// false.
///
/// Real time: noexcept, a thread-local read.
[[nodiscard]] std::uint64_t heap_operations_of_this_thread() noexcept;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kCountsHeapOperations = false;
#else
inline constexpr bool kCountsHeapOperations = true;
#endif

}  // namespace forcebound::time
