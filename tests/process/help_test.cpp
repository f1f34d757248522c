#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>

#include "forcebound/text/terminal.hpp"
#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;

/// Commands of `forcebound` that are programs of their own.
constexpr std::array kProgramCommands{"client", "server", "relay", "lab"};

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

/// A text that was broken by hand and then again to fit has lines of a word or two between full ones.
void expect_to_be_broken_once(const std::string& help) {
  std::istringstream in(help);
  std::vector<std::string> all;
  for (std::string line; std::getline(in, line);) all.push_back(line);
  const auto indent_of = [](const std::string& line) { return line.find_first_not_of(' '); };
  for (std::size_t i = 1; i + 1 < all.size(); ++i) {
    const std::size_t indent = indent_of(all[i]);
    const std::size_t next = indent_of(all[i + 1]);
    if (indent == std::string::npos || next != indent) continue;
    const bool goes_on = std::islower(static_cast<unsigned char>(all[i + 1][next])) != 0;
    const bool after_a_full_line = text::columns_of(all[i - 1]) + 10 > text::kColumns;
    const auto blanks = std::count(all[i].begin() + static_cast<std::ptrdiff_t>(indent), all[i].end(), ' ');
    EXPECT_FALSE(goes_on && after_a_full_line && blanks < 2) << all[i - 1] << '\n' << all[i] << '\n' << all[i + 1];
  }
}

/// Below "Options:" and "Arguments:" names are indented by two, with what they mean two blanks or more behind them or
/// on the next line, all in one column: by that help2man tells one option from the next.
void expect_each_option_to_stand_alone(const std::string& help) {
  constexpr std::size_t kName = 2;
  constexpr std::size_t kWords = 32;
  std::istringstream lines(help);
  bool listed = false;
  for (std::string line; std::getline(lines, line);) {
    if (line == "Options:" || line == "Arguments:") {
      listed = true;
      continue;
    }
    if (line.empty()) listed = false;
    if (!listed) continue;
    const std::size_t indent = line.find_first_not_of(' ');
    if (indent == kWords) continue;
    EXPECT_EQ(indent, kName) << line;
    // The name alone, or the words in their column.
    const bool alone = line.find("  ", kName) == std::string::npos;
    EXPECT_TRUE(alone ? (line.size() < kWords || line[kWords - 1] != ' ') &&
                            (line[kName] != '-' || line.find(" with ") == std::string::npos)
                      : line.compare(kWords - 2, 2, "  ") == 0 && line[kWords] != ' ')
        << line;
  }
}

void expect_common_style(const std::string& help) {
  expect_to_fit(help);
  expect_each_option_to_stand_alone(help);
  expect_to_be_broken_once(help);
  EXPECT_THAT(help, testing::HasSubstr("print this help and end"));
  for (const char* const foreign : {"TEXT", "FLOAT", "UINT", "INT:", "ENUM", "Needs:", "REQUIRED", "Print this help"}) {
    EXPECT_THAT(help, testing::Not(testing::HasSubstr(foreign)));
  }
}

TEST(Help, OfEveryProgramAndSubcommandFitsEightyColumnsInTheCommonStyle) {
  for (const char* const program : {kForcebound, kServer, kClient, kRelay, kLab, kRos2}) {
    if (program == nullptr) continue;
    SCOPED_TRACE(program);
    const Ran ran = run(program, {"--help"}, 10s);
    EXPECT_EQ(ran.exit_code, 0);
    EXPECT_EQ(ran.err, "");
    expect_common_style(ran.out);
    EXPECT_THAT(ran.out, testing::HasSubstr("print the version and end"));
    const auto subcommands = subcommands_in(ran.out);
    EXPECT_EQ(subcommands.empty(), program != kForcebound && program != kLab);
    const std::string name = std::filesystem::path(program).filename().string();
    for (const std::string& subcommand : subcommands) {
      SCOPED_TRACE(subcommand);
      const Ran of = run(program, {subcommand, "--help"}, 10s);
      EXPECT_EQ(of.exit_code, 0);
      expect_common_style(of.out);
      const bool is_program = std::ranges::find(kProgramCommands, subcommand) != kProgramCommands.end();
      if (is_program) continue;
      std::string example("  ");
      example.append(name).append(" ").append(subcommand).append(" ");
      EXPECT_THAT(of.out, testing::HasSubstr(example)) << "an example of its own";
      EXPECT_THAT(of.out, testing::Not(testing::HasSubstr("Exit code"))) << "that is the whole program's";
      const bool draws = of.out.find("--figure") != std::string::npos;
      EXPECT_EQ(unwrapped(of.out).find("data and script go beside it") != std::string::npos, draws);
    }
  }
}

TEST(Help, HasALineForEachCommandOfForcebound) {
  const std::string help = run(kForcebound, {"--help"}, 10s).out;
  const std::size_t begin = help.find("Subcommands:\n");
  const std::size_t end = help.find("\n\n", begin);
  ASSERT_NE(end, std::string::npos);
  EXPECT_EQ(lines(help.substr(begin, end - begin)), subcommands_in(help).size()) << help;
}

TEST(Help, OfEveryLawFitsEightyColumns) {
  const Ran help = run(kForcebound, {"replay", "--help"}, 10s);
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

TEST(EveryCommand, PrintsWhatFitsEightyColumns) {
  const TemporaryFolder folder;
  const std::string recording = folder.file("a-run-with-a-name-of-some-length.mcap");
  const std::string summary = folder.file("run.json");
  {
    Server server({"--scene", "sphere"});
    Relay relay(server.address(), {"--netem", "delay 20ms 5ms loss 5%"});
    Client client(relay.address(), {"--device", "omni", "--operator", "trace-sphere", "--duration", "2", "--record",
                                    recording, "--once"});
    EXPECT_EQ(client.wait(30s), 0) << client.err();
    write_file(summary, client.summary_text());
    EXPECT_EQ(relay.stop(), 0);
    EXPECT_EQ(server.stop(), 0);
    for (const std::string& out : {client.out(), relay.out(), server.out()}) expect_to_fit(out);
  }
  const auto expect_of = [](const char* program, const Words& words) {
    SCOPED_TRACE(testing::PrintToString(words));
    const Ran ran = run(program, words, 240s);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_GT(lines(ran.out), 2U);
    expect_to_fit(ran.out);
  };
  for (const char* const scene : {"wall", "sphere", "palpation", "microsurgery"}) {
    expect_of(kServer, {"--scene", scene, "--explain"});
  }
  expect_of(kForcebound, {"report", recording});
  expect_of(kForcebound, {"table", recording, summary});
  expect_of(kLab, {"reproduce", "wall"});
  expect_of(kLab, {"passivity", "--seeds", "1", "--seconds", "0.05"});
  expect_of(kLab, {"soak", "--seeds", "3"});
  expect_of(kLab, {"compare", "--laws", "none,fba-exact", "--scenes", "wall", "--network", "none", "--stiffness",
                   "10000", "--delays", "1", "--effort", "1"});
  expect_of(kLab, {"accuracy", "sphere", "--sweep", "law=none,fba-exact", "--rtt", "1,20", "--duration", "2"});
  expect_of(kLab, {"accuracy", "soft_pad", "--sweep", "tissue.pad.shape.cells=[2,2,1],[3,3,2]", "--rtt", "20",
                   "--duration", "2"});
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
