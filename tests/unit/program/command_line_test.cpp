#include "forcebound/program/command_line.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <new>
#include <stdexcept>

#include "forcebound/text/file.hpp"

namespace forcebound::program {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A program with options and a command.
struct Example {
  Example() {
    set_up(app, "example");
    app.add_option("--law", law, "law to run")
        ->check(one_of("law", {"none", "fba-less"}))
        ->type_name("LAW")
        ->capture_default_str();
    app.add_option("--rate", rate, "most answers per second")->check(number_above_zero())->type_name("HZ");
    app.add_option("--depth", depth, "target depth")->check(number_within(0, 0.1))->type_name("M");
    app.add_option("--offset", offset, "along x")->check(number())->type_name("M");
    app.add_option("--seed", seed, "first seed")->check(whole_within(1, 9))->type_name("N");
    app.add_option("--record", file, "file to write")->check(not_empty())->type_name("FILE");
    app.add_flag("--quiet", quiet, "print nothing")->excludes("--record");
    command = app.add_subcommand("table", "Print runs side by side");
    command->add_option("RUN", runs, "FILE.json")->required();
    command->callback([this] {
      if (runs.front() == "wrong") throw std::invalid_argument("RUN: 'wrong' is no file");
      if (runs.front() == "missing") throw std::runtime_error("missing: cannot be read");
    });
  }

  CLI::App app;
  CLI::App* command = nullptr;
  std::string law = "none";
  double rate = 0;
  double depth = 0;
  double offset = 0;
  std::uint64_t seed = 0;
  std::string file;
  bool quiet = false;
  std::vector<std::string> runs;
};

struct Ended {
  int exit_code = -1;
  std::string out;
  std::string err;
};

Ended ended(std::vector<const char*> words) {
  words.insert(words.begin(), "example");
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int exit_code = run("example", [&] {
    Example example;
    parse(example.app, static_cast<int>(words.size()), words.data());
    return kDone;
  });
  std::fflush(stdout);
  return {exit_code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

TEST(CommandLine, EndsWithZeroWhereAllIsWell) {
  const Ended all_well =
      ended({"--law", "fba-less", "--rate", "5", "--depth", "0.1", "--seed", "9", "table", "a.json"});
  EXPECT_EQ(all_well.exit_code, kDone);
  EXPECT_EQ(all_well.out + all_well.err, "");
}

TEST(CommandLine, PrintsHelpWithoutChecksAndTypesOfTheLibrary) {
  const Ended help = ended({"--help"});
  EXPECT_EQ(help.exit_code, kDone);
  EXPECT_EQ(help.err, "");
  EXPECT_THAT(help.out,
              AllOf(HasSubstr("--law LAW=none "), HasSubstr("--rate HZ "), HasSubstr("print this help and end"),
                    HasSubstr("print the version and end"), Not(HasSubstr("UINT"))));
  EXPECT_THAT(ended({"table", "--help"}).out, AllOf(HasSubstr("RUN ... "), HasSubstr("FILE.json (required)")));
}

/// What is said on one line of stderr, between the program's name and where to find help.
std::string wrong_use_of(const std::vector<const char*>& words, const std::string& command = "example") {
  const Ended end = ended(words);
  EXPECT_EQ(end.exit_code, kWrongUse);
  EXPECT_EQ(end.out, "");
  const std::string before = "example: ";
  const std::string after = " (see " + command + " --help)\n";
  EXPECT_THAT(end.err, AllOf(testing::StartsWith(before), testing::EndsWith(after)));
  if (end.err.size() < before.size() + after.size()) return end.err;
  return end.err.substr(before.size(), end.err.size() - before.size() - after.size());
}

TEST(CommandLine, SaysInItsOwnWordsWhatWouldBeAccepted) {
  EXPECT_EQ(wrong_use_of({"--law", "fba-les"}),
            "--law: unknown law 'fba-les', did you mean 'fba-less'? (known: none, fba-less)");
  EXPECT_EQ(wrong_use_of({"--rate", "0"}), "--rate: must be a number above 0, up to 1e9, got '0'");
  EXPECT_EQ(wrong_use_of({"--depth", "nan"}), "--depth: must be a number from 0 to 0.1, got 'nan'");
  EXPECT_EQ(wrong_use_of({"--seed", "1.5"}), "--seed: must be a whole number from 1 to 9, got '1.5'");
  EXPECT_EQ(wrong_use_of({"--seed", "-1"}), "--seed: must be a whole number from 1 to 9, got '-1'");
  EXPECT_THAT(wrong_use_of({"--record", "a", "--quiet"}),
              testing::AnyOf("--quiet does not go with --record", "--record does not go with --quiet"));
  EXPECT_EQ(wrong_use_of({"--record", ""}), "--record: must not be empty");
  EXPECT_EQ(wrong_use_of({"--seed"}), "--seed needs a value");
  EXPECT_EQ(wrong_use_of({"--seed", "1", "--seed", "2"}), "--seed is given more than once");
  EXPECT_EQ(wrong_use_of({"--sed", "1"}), "unknown option '--sed', did you mean '--seed'?");
  EXPECT_EQ(wrong_use_of({"--lx", "1"}), "unknown option '--lx'") << "the dashes make nothing alike";
  EXPECT_EQ(wrong_use_of({"--offset", "1e999"}), "--offset: must be a number such as 0.25 or -1e-3, got '1e999'");
  EXPECT_EQ(wrong_use_of({"tabel"}), "unknown command 'tabel', did you mean 'table'? (known: table)");
  EXPECT_EQ(wrong_use_of({"table"}, "example table"), "RUN is required");
}

TEST(CommandLine, TellsWrongUseFromFailure) {
  EXPECT_EQ(wrong_use_of({"table", "wrong"}, "example table"), "RUN: 'wrong' is no file");
  const Ended failed = ended({"table", "missing"});
  EXPECT_EQ(failed.exit_code, kFailed);
  EXPECT_EQ(failed.err, "example: missing: cannot be read\n");
}

TEST(CommandLine, NeverPrintsControlCharactersOfWhatItRefuses) {
  EXPECT_EQ(wrong_use_of({"--law", "\x1b[2J"}), "--law: unknown law '?[2J' (known: none, fba-less)");
  testing::internal::CaptureStderr();
  EXPECT_EQ(run("example", []() -> int { throw std::runtime_error("a.toml\x9b: line\nseed 1"); }), kFailed);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "example: a.toml?: line\nseed 1\n");
}

TEST(CommandLine, TellsLostOutputFromFailure) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(run("example",
                []() -> int {
                  text::write_file("/dev/full", "1");
                  return kDone;
                }),
            kOutputLost);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "example: /dev/full: cannot be written: No space left on device\n");
}

/// Of a program that prints a line and ends with `exit_code`, where every write to standard output finds no space left.
Ended ended_on_full_disk(int exit_code) {
  testing::internal::CaptureStderr();
  std::fflush(stdout);
  const int kept = dup(STDOUT_FILENO);
  const int full = open("/dev/full", O_WRONLY | O_CLOEXEC);
  dup2(full, STDOUT_FILENO);
  close(full);
  const int ended_with = run("example", [exit_code] {
    std::fputs("a line\n", stdout);
    return exit_code;
  });
  dup2(kept, STDOUT_FILENO);
  close(kept);
  std::clearerr(stdout);
  return {ended_with, "", testing::internal::GetCapturedStderr()};
}

TEST(CommandLine, SaysThatStandardOutputIsLost) {
  const Ended done = ended_on_full_disk(kDone);
  EXPECT_EQ(done.exit_code, kOutputLost);
  EXPECT_EQ(done.err, "example: standard output: cannot be written: No space left on device\n");
  EXPECT_EQ(ended_on_full_disk(kNeverConnected).exit_code, kOutputLost);
  for (const int worse : {kFailed, kNotPassive}) EXPECT_EQ(ended_on_full_disk(worse).exit_code, worse);
}

TEST(CommandLine, SaysThatThereIsNotEnoughMemory) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(run("example", []() -> int { throw std::bad_alloc(); }), kFailed);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "example: there is not enough memory\n");
}

TEST(ValueOf, PutsTheOptionsNameInFrontOfWhatIsWrong) {
  EXPECT_EQ(value_of("--at", [] { return 7; }), 7);
  EXPECT_THAT([] { value_of("--at", [] { throw std::invalid_argument("must be HOST:PORT"); }); },
              testing::ThrowsMessage<std::invalid_argument>("--at: must be HOST:PORT"));
}

TEST(AcceptedBy, IsWhatTheParserAccepts) {
  const CLI::Validator even = accepted_by([](const std::string& text) {
    if (text.size() % 2 != 0) throw std::invalid_argument("must have an even length");
  });
  EXPECT_EQ(even("ab"), "");
  EXPECT_EQ(even("abc"), "must have an even length");
}

TEST(Outputs, ReplaceNoFileOfAnotherOption) {
  const auto apart = [](const std::string& output, const std::string& input) {
    expect_apart({"--record", output}, {{"--device", ""}, {"--scene", input}});
  };
  EXPECT_THAT([&] { apart("a.toml", "./a.toml"); },
              testing::ThrowsMessage<std::invalid_argument>(
                  testing::StrEq("--record 'a.toml' would replace the file of --scene: give it another name")));
  EXPECT_NO_THROW(apart("a.mcap", "a.toml"));
  EXPECT_NO_THROW(apart("", ""));
  EXPECT_NO_THROW(apart("/dev/null", "/dev/null")) << "a device takes everything";
}

}  // namespace
}  // namespace forcebound::program
