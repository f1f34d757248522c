#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>

#include "forcebound/time/heap_operations.hpp"
#include "tests/support/process.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;

constexpr int kFewMotions = 200;
constexpr int kManyMotions = 1200;

std::string counted_of(const std::string& which, int motions) {
  Process counter(SCENE_COST_COUNTER, {which, std::to_string(motions)});
  EXPECT_EQ(counter.wait(60s), 0);
  return counter.out();
}

/// Instructions that valgrind's callgrind counts for the whole program.
std::int64_t instructions(const std::string& which, int motions) {
  const TemporaryFolder folder;
  Process counted(FORCEBOUND_VALGRIND, {"--tool=callgrind", "--callgrind-out-file=" + folder.file("callgrind.out"),
                                        SCENE_COST_COUNTER, which, std::to_string(motions)});
  EXPECT_EQ(counted.wait(100s), 0);
  const std::string output = counted.err();
  const std::string mark = "Collected : ";
  const std::size_t at = output.find(mark);
  if (at == std::string::npos) {
    ADD_FAILURE() << output;
    return 0;
  }
  return std::stoll(output.substr(at + mark.size()));
}

double instructions_per_motion(const std::string& which) {
  const std::int64_t more = instructions(which, kManyMotions) - instructions(which, kFewMotions);
  return static_cast<double>(more) / (kManyMotions - kFewMotions);
}

TEST(UnrequestedEffects, ChangeNeitherABitOfAForceNorAByteNorAnAllocation) {
  const std::string alone = counted_of("only", kManyMotions);
  EXPECT_EQ(counted_of("all", kManyMotions), alone);
  EXPECT_NE(alone.find("forces "), std::string::npos);
  if (time::kCountsHeapOperations) {
    EXPECT_NE(alone.find("heap operations 0\n"), std::string::npos) << alone;
  }
}

TEST(UnrequestedEffects, CostNoInstruction) {
  if (std::string(FORCEBOUND_VALGRIND).empty()) GTEST_SKIP() << "valgrind is not installed";
  if (!time::kCountsHeapOperations) GTEST_SKIP() << "valgrind does not work with a sanitizer";
  const double alone = instructions_per_motion("only");
  const double among_all = instructions_per_motion("all");
  std::cout << "instructions per motion over 100 objects: " << alone << " alone, " << among_all << " among all\n";
  EXPECT_GT(alone, 1000);
  EXPECT_LT(std::abs(among_all / alone - 1), 1e-3);
}

}  // namespace
}  // namespace forcebound::test
