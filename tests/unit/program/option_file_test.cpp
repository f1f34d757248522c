#include "forcebound/program/option_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "forcebound/config/config_error.hpp"
#include "forcebound/program/command_line.hpp"
#include "forcebound/text/file.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::program {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class OptionFile : public testing::Test {
 protected:
  OptionFile() {
    set_up(app_, "example");
    app_.add_option("--listen", listen_, "address")->type_name("HOST:PORT");
    app_.add_option("--load-max", load_max_, "share")->check(number_within(0, 1));
    app_.add_option("--sessions-max", sessions_max_, "clients")->check(whole_within(1, 100));
    app_.add_option("--scenes", scenes_, "scenes")->delimiter(',')->allow_extra_args(false);
    app_.add_flag("-r,--realtime", realtime_, "ask for it");
    add_option_file(app_);
  }

  /// @return what ends the program; empty: it goes on
  std::string parse(const std::string& file, const std::vector<std::string>& words = {}) {
    text::write_file(path_, file);
    std::vector<const char*> argv{"example", "--config", path_.c_str()};
    for (const std::string& word : words) argv.push_back(word.c_str());
    try {
      program::parse(app_, static_cast<int>(argv.size()), argv.data());
    } catch (const End& end) {
      return end.text;
    }
    return {};
  }

  test::TemporaryFolder folder_;
  std::string path_ = folder_.file("server.toml");
  CLI::App app_;
  std::string listen_;
  double load_max_ = 0;
  int sessions_max_ = 0;
  std::vector<std::string> scenes_;
  bool realtime_ = false;
};

TEST_F(OptionFile, GivesOptionsByTheirNames) {
  EXPECT_EQ(parse("listen = \"0.0.0.0:47800\"\nload-max = 0.25\nsessions-max = 7\nrealtime = true\n"
                  "scenes = [\"wall\", \"ball\"]\n"),
            "");
  EXPECT_EQ(listen_, "0.0.0.0:47800");
  EXPECT_EQ(load_max_, 0.25);
  EXPECT_EQ(sessions_max_, 7);
  EXPECT_THAT(scenes_, ElementsAre("wall", "ball"));
  EXPECT_TRUE(realtime_);
}

TEST_F(OptionFile, ComesAfterTheCommandLine) {
  EXPECT_EQ(parse("listen = \"0.0.0.0:1\"\nscenes = [\"wall\"]\nrealtime = true\nsessions-max = 7\n",
                  {"--listen=[::1]:2", "--scenes", "ball", "-r"}),
            "");
  EXPECT_EQ(listen_, "[::1]:2");
  EXPECT_THAT(scenes_, ElementsAre("ball"));
  EXPECT_TRUE(realtime_);
  EXPECT_EQ(sessions_max_, 7);
}

TEST_F(OptionFile, WithFalseLeavesAFlagOut) {
  EXPECT_EQ(parse("realtime = false\n"), "");
  EXPECT_FALSE(realtime_);
}

TEST_F(OptionFile, RefusesAnUnknownKeyWithItsLine) {
  EXPECT_THAT(parse("\nlisten = \"[::1]:1\"\nsesions-max = 7\n"),
              HasSubstr("server.toml:3: unknown key 'sesions-max', did you mean 'sessions-max'?"));
  EXPECT_THAT(parse("config = \"other.toml\"\n"), HasSubstr("server.toml:1: unknown key 'config'"));
  EXPECT_THAT(parse("[server]\nlisten = \"[::1]:1\"\n"), HasSubstr("server.toml:1: unknown key 'server'"));
}

TEST_F(OptionFile, RefusesAValueOfTheWrongType) {
  EXPECT_THAT(parse("realtime = 1\n"), HasSubstr("server.toml:1: realtime must be true or false, got 1"));
  EXPECT_THAT(parse("listen = true\n"), HasSubstr("server.toml:1: listen must be a text or a number, got true"));
  EXPECT_THAT(parse("listen = [\"a\"]\n"), HasSubstr("server.toml:1: listen must be a text or a number"));
  EXPECT_THAT(parse("load-max = 2\n"), HasSubstr("--load-max: must be a number from 0 to 1, got '2'"));
}

TEST_F(OptionFile, ThatIsNoTomlIsRefused) {
  EXPECT_THAT([this] { parse("listen = \n"); },
              testing::ThrowsMessage<config::ConfigError>(HasSubstr("server.toml:1: not TOML")));
}

TEST_F(OptionFile, ThatIsMissingIsNamed) {
  const std::string missing = folder_.file("missing.toml");
  const std::vector<const char*> argv{"example", "--config", missing.c_str()};
  EXPECT_THAT([&] { program::parse(app_, static_cast<int>(argv.size()), argv.data()); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("missing.toml")));
}

TEST_F(OptionFile, IsNotNeeded) {
  const std::vector<const char*> argv{"example", "--listen", "[::1]:1"};
  EXPECT_THAT(with_option_file(app_, static_cast<int>(argv.size()), argv.data()), ElementsAre("--listen", "[::1]:1"));
  EXPECT_THAT(with_option_file(app_, 1, argv.data()), IsEmpty());
}

}  // namespace
}  // namespace forcebound::program
