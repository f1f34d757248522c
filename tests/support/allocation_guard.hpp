#pragma once

#include <gtest/gtest.h>

#include <cstdint>

#include "forcebound/time/heap_operations.hpp"

namespace forcebound::test {

/// Counts this thread's heap operations since it was made.
class AllocationGuard {
 public:
  AllocationGuard() noexcept : before_(time::heap_operations_of_this_thread()) {}

  [[nodiscard]] std::uint64_t heap_operations() const noexcept {
    return time::heap_operations_of_this_thread() - before_;
  }

 private:
  std::uint64_t before_;
};

}  // namespace forcebound::test

// A macro, since only the test's own body can skip the test.
#define FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT()                                       \
  if (!::forcebound::time::kCountsHeapOperations) {                                      \
    GTEST_SKIP() << "the sanitizer replaces malloc, so heap operations are not counted"; \
  }                                                                                      \
  static_assert(true, "")
