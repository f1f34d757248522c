#pragma once

#include <gtest/gtest.h>

#include "forcebound/time/allocation_count.hpp"

namespace forcebound::test {

/// Runs `work` and fails if this thread allocated meanwhile. Visibly skips what cannot be known under a sanitizer.
template <typename Work>
void expect_no_allocation(Work&& work) {
  const auto before = time::allocations_of_this_thread();
  work();
  const auto made = time::allocations_of_this_thread() - before;
  if (!time::counts_allocations) GTEST_SKIP() << "allocations cannot be counted under a sanitizer";
  EXPECT_EQ(made, 0U) << "heap allocations where there must be none";
}

}  // namespace forcebound::test
