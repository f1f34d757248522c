#include "tests/tools/lab/accuracy/instruction_counter.hpp"

#include <gtest/gtest.h>

namespace forcebound::lab {
namespace {

TEST(InstructionCounter, CountsInstructionsWhereTheKernelPermitsIt) {
  const InstructionCounter counter;
  const auto before = counter.count();
  if (!before) GTEST_SKIP() << "the kernel does not permit counting instructions here";
  constexpr int kTurns = 100000;
  volatile int sink = 1;
  for (int i = 0; i < kTurns; ++i) sink = sink + 1;
  const auto after = counter.count();
  ASSERT_TRUE(after);
  EXPECT_GT(*after - *before, kTurns);
  EXPECT_LT(*after - *before, 100 * kTurns);
}

}  // namespace
}  // namespace forcebound::lab
