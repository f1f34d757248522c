#pragma once

#include <cstdint>

namespace forcebound::tests {

/// Counts this thread's heap operations (malloc, free and their kin, so operator new and delete as well) since it was
/// made.
///
/// Linking it replaces malloc for the whole test program. Under a sanitizer, which needs malloc for itself, nothing is
/// counted: begin a test that relies on it with FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT().
class AllocationGuard {
 public:
  AllocationGuard() noexcept;

  [[nodiscard]] std::uint64_t heap_operations() const noexcept;

  /// Whether this build counts at all.
  [[nodiscard]] static bool counts() noexcept;

 private:
  std::uint64_t before_;
};

}  // namespace forcebound::tests

// A macro, since only the test's own body can skip it.
#define FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT()          \
  if (!::forcebound::tests::AllocationGuard::counts()) {    \
    GTEST_SKIP() << "a sanitizer owns malloc; not counted"; \
  }                                                         \
  static_assert(true, "")
