#include "forcebound/server/runtime/memory_in_use.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::server {
namespace {

TEST(MemoryInUse, RisesAndFallsWithWhatIsAllocatedInSmallPartsAndLarge) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const std::size_t bytes : {std::size_t{1} << 16U, std::size_t{1} << 26U}) {
    const std::size_t before = memory_in_use();
    {
      const std::unique_ptr<char[]> taken(new char[bytes]);
      static_cast<volatile char*>(taken.get())[0] = 1;
      EXPECT_GE(memory_in_use(), before + bytes);
      EXPECT_LE(memory_in_use(), before + bytes + 8192);
    }
    EXPECT_LE(memory_in_use(), before + 8192);
  }
}

TEST(MemoryInUse, IsLessThanTheMachineHas) { EXPECT_LT(memory_in_use(), memory_of_machine()); }

}  // namespace
}  // namespace forcebound::server
