#include "forcebound/program/exit_codes.hpp"

#include <gtest/gtest.h>

#include "forcebound/program/command_line.hpp"

namespace forcebound::program {
namespace {

TEST(ExitCodes, AreThoseThatAProgramEndsWith) {
  EXPECT_EQ(exit_codes_without({}), kExitCodes);
  EXPECT_EQ(exit_codes_without({kNotPassive, kNeverConnected, kDriverCrashed}),
            "Exit code: 0 done, 1 failed, 2 wrong use, 4 output lost.");
}

}  // namespace
}  // namespace forcebound::program
