#include "forcebound/program/progress.hpp"

#include <gtest/gtest.h>

#include "forcebound/text/terminal.hpp"

namespace forcebound::program {
namespace {

TEST(Progress, SaysHowMuchIsDoneAndHowLongTheRestTakes) {
  EXPECT_EQ(Progress::line(0.25, "12 of 48 runs", 10), "12 of 48 runs, 25 %, about 30 s left");
  EXPECT_EQ(Progress::line(0.5, "half", 600), "half, 50 %, about 10 min left");
  EXPECT_EQ(Progress::line(1, "all", 7), "all, 100 %, about 0 s left");
}

TEST(Progress, DoesNotGuessBeforeAnythingIsDone) { EXPECT_EQ(Progress::line(0, "runs", 3), "runs, 0 %"); }

TEST(Progress, FitsATerminalsLine) { EXPECT_LT(Progress::line(0.1, std::string(200, 'x'), 3).size(), text::kColumns); }

}  // namespace
}  // namespace forcebound::program
