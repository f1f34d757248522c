#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "forcebound/text/terminal.hpp"
#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;

/// The names that a program's help lists below "Subcommands:".
std::vector<std::string> subcommands_in(const std::string& help) {
  std::vector<std::string> names;
  std::istringstream lines(help);
  bool listed = false;
  for (std::string line; std::getline(lines, line);) {
    if (line == "Subcommands:") {
      listed = true;
    } else if (listed && line.size() > 2 && line.starts_with("  ") && line[2] != ' ') {
      names.push_back(line.substr(2, line.find(' ', 2) - 2));
    } else if (listed && !line.starts_with("  ")) {
      break;
    }
  }
  return names;
}

void expect_to_fit(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(text::columns_of(line), text::kColumns) << line;
  }
}

TEST(Help, OfEveryProgramAndSubcommandFitsEightyColumns) {
  for (const char* const program : {kServer, kClient, kRelay, kLab}) {
    SCOPED_TRACE(program);
    const Ran ran = run(program, {"--help"}, 10s);
    EXPECT_EQ(ran.exit_code, 0);
    EXPECT_EQ(ran.err, "");
    expect_to_fit(ran.out);
    const auto subcommands = subcommands_in(ran.out);
    EXPECT_EQ(subcommands.empty(), program != kLab);
    for (const std::string& subcommand : subcommands) {
      SCOPED_TRACE(subcommand);
      const Ran of = run(program, {subcommand, "--help"}, 10s);
      EXPECT_EQ(of.exit_code, 0);
      EXPECT_THAT(of.out, testing::HasSubstr("--help"));
      expect_to_fit(of.out);
    }
  }
}

TEST(Help, OfEveryLawFitsEightyColumns) {
  const Ran help = run(kLab, {"replay", "--help"}, 10s);
  std::istringstream lines(help.out.substr(help.out.find("Laws:\n")));
  std::string line;
  std::getline(lines, line);
  int laws = 0;
  while (std::getline(lines, line) && line.starts_with("  ")) {
    if (line[2] == ' ') continue;  // goes on
    ++laws;
    const std::string law = line.substr(2, line.find(' ', 2) - 2);
    SCOPED_TRACE(law);
    const Ran of = run(kClient, {"--law-help", law, "--device", "wall-1dof"}, 10s);
    EXPECT_EQ(of.exit_code, 0);
    expect_to_fit(of.out);
  }
  EXPECT_GT(laws, 10);
}

TEST(Lab, WritesNeitherProgressNorColourToAFile) {
  const Ran ran = run(kLab, {"trials", "wall", "--device", "wall-1dof", "--operator", "press", "--seconds", "2"}, 60s);
  EXPECT_EQ(ran.exit_code, 0);
  EXPECT_EQ(ran.err, "");
  EXPECT_THAT(ran.out, testing::Not(testing::HasSubstr("\033")));
  expect_to_fit(ran.out);
}

TEST(Lab, PlaysTheSameTrialsTwiceByteForByte) {
  const Words words{"trials", "sphere", "--seconds", "3", "--netem", "delay 20ms 5ms loss 5%"};
  const Ran one = run(kLab, words, 60s);
  EXPECT_EQ(one.exit_code, 0) << one.err;
  EXPECT_THAT(one.out, testing::HasSubstr("fba-exact"));
  EXPECT_EQ(run(kLab, words, 60s).out, one.out);
}

}  // namespace
}  // namespace forcebound::test
