#include "forcebound/client/commands/commands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace forcebound::client::commands {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ReplayCommandTest : public testing::Test {
 protected:
  ReplayCommandTest() {
    fs::create_directories(folder_);
    std::ofstream(input_) << "time_s,x0_m,x1_m,fe0_N,fe1_N\n0,0,0,0,0\n0.001,9.765625e-4,0,-3,-4\n";
  }
  ~ReplayCommandTest() override { fs::remove_all(folder_); }

  static void run(const std::string& options) {
    CLI::App program{"test"};
    add_replay(program);
    program.parse("replay " + options);
  }

  /// Empty: success.
  std::string wrong_use_of(const std::string& options) {
    try {
      run(options);
    } catch (const CLI::Error& error) {
      return error.what();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  }

  std::string replayed(const std::string& options) {
    EXPECT_EQ(wrong_use_of(options + " --input " + input_ + " --output " + output_), "");
    std::ifstream file(output_);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / ("replay-command-" + std::to_string(::getpid()));
  const std::string input_ = (folder_ / "in.csv").string();
  const std::string output_ = (folder_ / "out.csv").string();
};

TEST_F(ReplayCommandTest, ReplaysAFileIntoAFile) {
  EXPECT_EQ(replayed("--law none --damping 16 --period 0.015625"),
            "time_s,f0_N,f1_N,energy_J,xi\n0,0,0,0,1\n0.001,-3,-4,0.0009765625,1\n");
}

TEST_F(ReplayCommandTest, TakesEveryOption) {
  EXPECT_THAT(
      replayed("--law none --damping 30,30 --damping-matrix \"16,4;4,16\" --period 0.015625 --encoder 1e-5,1e-5 "
               "--friction 0.1 --hold 2e-3 --latency 1e-4 --force-max 2.5 --memory full"),
      HasSubstr("\n0.001,-1.5,-2,0.0009765625,1\n"));
}

TEST_F(ReplayCommandTest, NamesTheOptionThatIsWrong) {
  const std::string files = " --input " + input_ + " --output " + output_;
  EXPECT_THAT(wrong_use_of("--damping 30" + files), HasSubstr("--law is required"));
  EXPECT_THAT(wrong_use_of("--law fba-exactly --damping 30" + files),
              HasSubstr("--law: unknown law 'fba-exactly', did you mean 'fba-exact'? (known: none, fba-less,"));
  EXPECT_THAT(wrong_use_of("--law none" + files), HasSubstr("--damping or --damping-matrix must be given"));
  EXPECT_THAT(wrong_use_of("--law none --damping 3o" + files), HasSubstr("--damping: '3o' is not a number"));
  EXPECT_THAT(wrong_use_of("--law none --damping 1,,2" + files), HasSubstr("--damping: '' is not a number"));
  EXPECT_THAT(wrong_use_of("--law none --damping-matrix 1,2;x,1" + files), HasSubstr("--damping-matrix: 'x' is not"));
  EXPECT_THAT(wrong_use_of("--law none --damping 1 --period soon" + files), HasSubstr("--period"));
  EXPECT_THAT(wrong_use_of("--law none --damping 1 --memory some" + files), HasSubstr("--memory"));
  EXPECT_THAT(wrong_use_of("--law none --damping 1 --velocity 1" + files), HasSubstr("--velocity"));
}

TEST_F(ReplayCommandTest, SaysWhichFileCannotBeOpened) {
  EXPECT_THAT([&] { run("--law none --damping 1 --input /nowhere/in.csv"); },
              testing::ThrowsMessage<std::runtime_error>("/nowhere/in.csv: cannot be read: No such file or "
                                                         "directory"));
  EXPECT_THAT([&] { run("--law none --damping 1 --input " + input_ + " --output /nowhere/out.csv"); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("/nowhere/out.csv: cannot be written")));
}

TEST_F(ReplayCommandTest, WritesNoFileForOptionsThatAreWrong) {
  EXPECT_NE(wrong_use_of("--law nun --damping 1 --input " + input_ + " --output " + output_), "");
  EXPECT_FALSE(fs::exists(output_));
}

}  // namespace
}  // namespace forcebound::client::commands
