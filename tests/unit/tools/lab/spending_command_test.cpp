#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <string>

#include "tests/tools/lab/commands.hpp"

namespace forcebound::lab {
namespace {

TEST(SpendingCommand, RefusesConstantsForTheGridWhichHasItsOwn) {
  for (const std::string option : {"--memory 1", "--rise 100", "--release-share 0.3", "--delay 5"}) {
    CLI::App program{"test"};
    add_spending(program);
    try {
      program.parse("spending --grid " + option);
      FAIL() << option << " is accepted";
    } catch (const CLI::ParseError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("excludes")) << option;
    }
  }
}

}  // namespace
}  // namespace forcebound::lab
