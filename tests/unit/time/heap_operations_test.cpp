#include "forcebound/time/heap_operations.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <thread>

namespace forcebound::time {
namespace {

class HeapOperations : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!kCountsHeapOperations) GTEST_SKIP() << "the sanitizer replaces malloc";
  }
};

// Keeps the compiler from leaving out an unused allocation.
void use(const volatile void* memory) {
  static const volatile void* volatile last = nullptr;
  last = memory;
  (void)last;
}

TEST_F(HeapOperations, SeesEveryWayToAllocateAndToFree) {
  std::uint64_t before = heap_operations_of_this_thread();
  const auto grew = [&before] {
    const std::uint64_t now = heap_operations_of_this_thread();
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
  wide.reset();
  EXPECT_TRUE(grew());
}

TEST_F(HeapOperations, IsEachThreadsOwn) {
  const std::uint64_t before = heap_operations_of_this_thread();
  std::uint64_t others = 0;
  std::thread other([&others] {
    auto numbers = std::make_unique<int[]>(100);
    use(numbers.get());
    others = heap_operations_of_this_thread();
  });
  const std::uint64_t started = heap_operations_of_this_thread();
  other.join();
  EXPECT_GE(others, 1U);
  EXPECT_GE(started, before);
  EXPECT_EQ(heap_operations_of_this_thread(), started);
}

}  // namespace
}  // namespace forcebound::time
