#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/process/device_driver.hpp"
#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// While it lives, the environment has such a value.
class InEnvironment {
 public:
  InEnvironment(const char* name, const std::string& value) : name_(name) {
    if (const char* const before = std::getenv(name)) before_ = before;
    ::setenv(name, value.c_str(), 1);
  }
  ~InEnvironment() {
    if (before_) {
      ::setenv(name_, before_->c_str(), 1);
    } else {
      ::unsetenv(name_);
    }
  }
  InEnvironment(const InEnvironment&) = delete;
  InEnvironment& operator=(const InEnvironment&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_{};
};

class ForeignLocale : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(FORCEBOUND_LOCALES "/de_DE.UTF-8")) {
      GTEST_SKIP() << "no locale de_DE (Debian: apt-get install locales)";
    }
    // A sanitizer's runtime must be the first library.
    preloads_ = std::filesystem::exists(FORCEBOUND_FOREIGN_LOCALE);
  }

  InEnvironment folder_of_locales_{"LOCPATH", FORCEBOUND_LOCALES};
  InEnvironment chosen_{"LC_ALL", "de_DE.UTF-8"};
  TemporaryFolder folder_;
  bool preloads_ = false;
};

// What a driver does that follows setlocale's own example.
TEST_F(ForeignLocale, ChosenByADriverLeavesTheRecordingReadable) {
  const DriversForTests drivers;
  const std::string recording = folder_.file("run.mcap");
  Server server({"--scene", "wall"});
  Client client(server.address(),
                {"--device", "slider:fault=locale", "--law", "none", "--duration", "1", "--record", recording});
  EXPECT_EQ(client.wait(60s), client.expected_end()) << client.err();
  const nlohmann::json summary = client.summary();
  ASSERT_TRUE(summary.is_object());
  EXPECT_GT(summary["duration_s"], 0.5);
  const Ran report = run(kForcebound, {"report", recording});
  EXPECT_EQ(report.exit_code, 0);
  EXPECT_EQ(report.err, "");
  EXPECT_EQ(run(kForcebound, {"table", recording}).err, "");
}

// All that programs read and write as numbers: command lines, scenes with bodies (MuJoCo's XML), devices, words of the
// network, recordings, summaries, tables, figures' data.
TEST_F(ForeignLocale, ChangesNoNumberThatProgramsReadOrWrite) {
  if (!preloads_) GTEST_SKIP() << "not under a sanitizer";
  const std::string explain = run(kServer, {"--scene", "pick_and_place", "--explain"}).out;
  const Ran trials = run(kLab, {"trials", "sphere", "--seconds", "0.5", "--json", folder_.file("before.json")}, 300s);
  const InEnvironment foreign("FORCEBOUND_TEST_PRELOAD", FORCEBOUND_FOREIGN_LOCALE);
  const Ran explained = run(kServer, {"--scene", "pick_and_place", "--explain"});
  EXPECT_EQ(explained.out, explain) << explained.err;
  const Ran again = run(kLab, {"trials", "sphere", "--seconds", "0.5", "--json", folder_.file("after.json")}, 300s);
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(again.out, trials.out);
  EXPECT_EQ(content(folder_.file("after.json")), content(folder_.file("before.json")));

  const std::string recording = folder_.file("run.mcap");
  Server server({"--scene", "pick_and_place"});
  Relay relay(server.address(), {"--netem", "delay 1.5ms 0.5ms loss 0.5%"});
  Client client(relay.address(),
                {"--device", "omni", "--operator", "wave", "--duration", "1.5", "--record", recording});
  EXPECT_EQ(client.wait(60s), client.expected_end()) << client.err();
  EXPECT_THAT(client.err(), Not(HasSubstr("not available")));
  EXPECT_NEAR(client.summary()["duration_s"].get<double>(), 1.5, 0.5);
  const Ran report = run(kForcebound, {"report", recording, "--json", folder_.file("report.json")});
  EXPECT_THAT(report.err, "");
  EXPECT_EQ(nlohmann::json::parse(content(folder_.file("report.json"))), client.summary());
  EXPECT_EQ(relay.stop(), 0);
}

}  // namespace
}  // namespace forcebound::test
