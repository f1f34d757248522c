#include "forcebound/time/allocation_count.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <thread>

namespace forcebound::time {
namespace {

class AllocationCount : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!counts_allocations) GTEST_SKIP() << "a sanitizer has malloc of its own";
  }
};

// Keeps the compiler from leaving out an allocation that nobody uses.
void use(const volatile void* memory) {
  static const volatile void* volatile last = nullptr;
  last = memory;
  (void)last;
}

TEST_F(AllocationCount, SeesEveryWayToAllocate) {
  std::uint64_t before = allocations_of_this_thread();
  const auto grew = [&before] {
    const std::uint64_t now = allocations_of_this_thread();
    return std::exchange(before, now) < now;
  };
  struct alignas(64) Wide {
    char bytes[64];
  };
  void* memory = std::malloc(10);
  use(memory);
  EXPECT_TRUE(grew());
  memory = std::realloc(memory, 100'000);
  use(memory);
  EXPECT_TRUE(grew());
  std::free(memory);
  memory = std::calloc(2, 3);
  use(memory);
  std::free(memory);
  EXPECT_TRUE(grew());
  auto number = std::make_unique<int>(1);
  use(number.get());
  EXPECT_TRUE(grew());
  auto wide = std::make_unique<Wide>();
  use(wide.get());
  EXPECT_TRUE(grew());
  EXPECT_FALSE(grew());
}

TEST_F(AllocationCount, IsEachThreadsOwn) {
  const std::uint64_t before = allocations_of_this_thread();
  std::uint64_t others = 0;
  std::thread other([&others] {
    auto numbers = std::make_unique<int[]>(100);
    use(numbers.get());
    others = allocations_of_this_thread();
  });
  const std::uint64_t started = allocations_of_this_thread();
  other.join();
  EXPECT_GE(others, 1U);
  EXPECT_GE(started, before);
  EXPECT_EQ(allocations_of_this_thread(), started);
}

}  // namespace
}  // namespace forcebound::time
