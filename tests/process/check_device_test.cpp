#include <gmock/gmock.h>

#include <cctype>
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/process/device_driver.hpp"
#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;

/// The command on a device of a driver for tests; a check can be found by its name.
class CheckDevice {
 public:
  explicit CheckDevice(const std::string& device, const Words& more = {}) {
    const DriversForTests drivers;
    Words words{"check-device", "--device", device, "--json", folder_.file("checks.json")};
    words.insert(words.end(), more.begin(), more.end());
    ran_ = run(kForcebound, words, 300s);
    const std::string json = content(folder_.file("checks.json"));
    checks_ = nlohmann::json::parse(json, nullptr, false);
  }

  [[nodiscard]] const Ran& ran() const { return ran_; }

  /// The names of the checks with this verdict.
  [[nodiscard]] std::vector<std::string> with(const std::string& verdict) const {
    std::vector<std::string> names;
    if (!checks_.is_array()) return {"no checks: " + ran_.err};
    for (const auto& check : checks_) {
      if (check.at("verdict") == verdict) names.push_back(check.at("check"));
    }
    return names;
  }

  [[nodiscard]] std::string measured(const std::string& name) const {
    for (const auto& check : checks_) {
      if (check.at("check") == name) return check.at("measured");
    }
    return "not checked: " + ran_.out;
  }

 private:
  TemporaryFolder folder_;
  Ran ran_;
  nlohmann::json checks_;
};

TEST(CheckDeviceCommand, PassesDriversThatAreRight) {
  for (const char* device : {"faulty:fault=none", "slider:axes=2"}) {
    const CheckDevice checked(device);
    EXPECT_EQ(checked.ran().exit_code, 0) << checked.ran().out << checked.ran().err;
    EXPECT_THAT(checked.with("failed"), testing::IsEmpty()) << device;
    EXPECT_THAT(checked.with("passed"),
                IsSupersetOf({"readings", "rate", "times run forward", "jitter", "rest at zero force", "force along +x",
                              "units along x", "not a number", "stop", "start again", "commands", "unknown setting",
                              "open again"}))
        << device;
    EXPECT_THAT(checked.with("not checked"), IsSupersetOf({"unplugging", "buttons"})) << device;
    // On a busy machine it may be at rest before it is judged.
    EXPECT_THAT(checked.measured("hold time"), Not(HasSubstr("not checked: "))) << device;
  }
}

struct Broken {
  const char* fault;
  const char* check;     ///< that fails
  const char* measured;  ///< part of its line
  Words more{};          ///< options
};

class CheckDeviceCommandFails : public testing::TestWithParam<Broken> {};

TEST_P(CheckDeviceCommandFails, WithTheRightLine) {
  const Broken& broken = GetParam();
  const CheckDevice checked("faulty:fault=" + std::string(broken.fault), broken.more);
  EXPECT_EQ(checked.ran().exit_code, 1) << checked.ran().out << checked.ran().err;
  EXPECT_THAT(checked.with("failed"), testing::Contains(broken.check)) << checked.ran().out;
  EXPECT_THAT(checked.measured(broken.check), HasSubstr(broken.measured));
  EXPECT_THAT(unwrapped(checked.ran().out), HasSubstr(std::string(broken.check) + " failed"));
  EXPECT_THAT(checked.ran().err, HasSubstr("failed "));
}

INSTANTIATE_TEST_SUITE_P(
    Each, CheckDeviceCommandFails,
    testing::Values(Broken{"sign", "force along +x", "moved -"}, Broken{"units", "units along x", "moves like"},
                    Broken{"axes", "force along +x", "along z"}, Broken{"clock", "reading times", "latched more than"},
                    Broken{"backwards", "times run forward", "ran backwards"}, Broken{"jitter", "jitter", "old"},
                    Broken{"ahead", "times run forward", "of 1000 ran backwards or lay in the future"},
                    Broken{"seldom", "rate", "80 %"}, Broken{"fails", "last error", "without a reason"},
                    Broken{"write", "commands", "failed"}, Broken{"holds", "hold time", "m/s"},
                    Broken{"blocks", "calls in time", "blocked"}, Broken{"drift", "rest at zero force", "moved"},
                    Broken{"wraps", "saturation", "moved -", {"--force-share", "1"}},
                    Broken{"nan", "readings", "not finite"}, Broken{"stop", "stop", "went on by"},
                    Broken{"settings", "unknown setting", "is accepted"},
                    Broken{"none", "force along +x", "faster than 0.05 m/s", {"--speed", "0.05"}}),
    [](const auto& tried) {
      std::string name = tried.param.fault;
      name[0] = static_cast<char>(std::toupper(name[0]));
      return name;
    });

TEST(CheckDeviceCommand, KeepsWhatItFoundBeforeACrash) {
  const CheckDevice checked("faulty:fault=crash-push");
  EXPECT_EQ(checked.ran().exit_code, 1);
  EXPECT_THAT(checked.with("failed"), testing::ElementsAre("calls")) << checked.ran().out;
  EXPECT_THAT(checked.with("passed"), IsSupersetOf({"readings", "rest at zero force", "force along +x"}));
  EXPECT_THAT(checked.measured("calls"),
              "in check 'force along +y' driver 'faulty' crashed in command (Segmentation fault); it was stopped");
}

TEST(CheckDeviceCommand, SaysThatADriverAborted) {
  const CheckDevice checked("faulty:fault=crash");
  EXPECT_EQ(checked.ran().exit_code, 1);
  EXPECT_THAT(checked.measured("calls"), HasSubstr("in check 'readings' driver 'faulty' crashed in read (Aborted)"));
}

TEST(CheckDeviceCommand, KeepsWhatItFoundBeforeTheDriverEndsTheProcess) {
  const CheckDevice checked("faulty:fault=exit");
  EXPECT_EQ(checked.ran().exit_code, 1);
  EXPECT_THAT(checked.with("passed"), testing::Contains("force along +x"));
  EXPECT_THAT(checked.measured("calls"),
              HasSubstr("in check 'force along +y' driver 'faulty' ended the program by exit() in command"));
}

TEST(CheckDeviceCommand, StopsADeviceWhoseDriverHangs) {
  const CheckDevice checked("faulty:fault=hang-push");
  EXPECT_EQ(checked.ran().exit_code, 1);
  EXPECT_THAT(checked.with("failed"), testing::ElementsAre("calls")) << checked.ran().out;
  EXPECT_THAT(checked.with("passed"), IsSupersetOf({"readings", "rest at zero force", "force along +x"}));
  EXPECT_THAT(checked.measured("calls"),
              AllOf(HasSubstr("command did not return within 2 s, in check 'force along +y'"),
                    HasSubstr("the device was stopped")));
}

TEST(CheckDeviceCommand, EndsIfStopHangsAsWell) {
  const CheckDevice checked("faulty:fault=hang-stop");
  EXPECT_EQ(checked.ran().exit_code, 1);
  EXPECT_THAT(checked.measured("calls"),
              AllOf(HasSubstr("command did not return"), HasSubstr("stop, called after that, did not return either")));
}

TEST(CheckDeviceCommand, SaysThatADriverHangsInARead) {
  const CheckDevice checked("faulty:fault=hang-read");
  EXPECT_EQ(checked.ran().exit_code, 1);
  EXPECT_THAT(checked.measured("calls"), HasSubstr("read did not return within 2 s, in check 'readings'"));
}

TEST(CheckDeviceCommand, SaysWhyADeviceDoesNotOpen) {
  EXPECT_THAT(CheckDevice("newer").measured("open"), HasSubstr("has interface 99, this program has 1"));
  EXPECT_THAT(CheckDevice("crashing").measured("open"), HasSubstr("ends the process that does it: Aborted"));
  EXPECT_EQ(CheckDevice("no-such-driver").ran().exit_code, 2);
}

TEST(CheckDeviceCommand, RefusesToGuideNobody) {
  const CheckDevice checked("slider", {"--guided"});
  EXPECT_EQ(checked.ran().exit_code, 2);
  EXPECT_THAT(checked.ran().err, HasSubstr("--guided asks a person at a terminal"));
}

TEST(CheckDeviceCommand, EndsWithZeroForceOnASignal) {
  const DriversForTests drivers;
  const TemporaryFolder folder;
  Process check(kForcebound, {"check-device", "--device", "faulty", "--json", folder.file("checks.json")});
  ASSERT_TRUE(check.wait_for("let nobody touch it"));
  EXPECT_EQ(check.stop(), 1) << check.err();
  EXPECT_THAT(check.out() + check.err(), Not(HasSubstr("calls")));
}

/// The command at a terminal, and a person at the device.
class GuidedCheckDevice {
 public:
  explicit GuidedCheckDevice(const std::string& fault)
      : lab_("/usr/bin/script",
             {"--quiet", "--return", "--command",
              std::string(kForcebound) + " check-device --guided --device faulty:fault=" + fault +
                  ",control=" + folder_.path().string() + " --json " + folder_.file("checks.json"),
              "/dev/null"},
             Process::Input::pipe) {}

  /// @param until a file of the driver, before it is plugged in; empty: at once
  void plays_a_person(const std::string& until = {}) {
    EXPECT_TRUE(lab_.wait_for("Unplug the device.", 120s));
    write_file(folder_.file("unplugged"), "");
    EXPECT_TRUE(lab_.wait_for("Plug the device in again", 120s));
    while (!until.empty() && !std::filesystem::exists(folder_.file(until)) && !lab_.wait(10ms)) continue;
    std::filesystem::remove(folder_.file("unplugged"));
    EXPECT_TRUE(lab_.wait_for("Press and release each button", 120s));
    write_file(folder_.file("button-1"), "");
    EXPECT_TRUE(lab_.wait_for("Pressed: 1", 120s));
    std::filesystem::remove(folder_.file("button-1"));
    EXPECT_TRUE(lab_.wait_for("Released: 1", 120s));
    lab_.write("\n");
    exit_code = lab_.wait(120s).value_or(-1);
  }

  [[nodiscard]] std::string line_of(const std::string& name) const {
    const nlohmann::json checks = nlohmann::json::parse(content(folder_.file("checks.json")), nullptr, false);
    if (!checks.is_array()) return lab_.out();
    for (const auto& check : checks) {
      if (check.at("check") == name)
        return check.at("verdict").get<std::string>() + ": " + std::string(check.at("measured"));
    }
    return "not there: " + lab_.out();
  }

  int exit_code = -1;

 private:
  DriversForTests drivers_;
  TemporaryFolder folder_;
  Process lab_;
};

TEST(CheckDeviceCommand, GuidesAPersonWhoUnplugsItAndPressesItsButtons) {
  GuidedCheckDevice checked("none");
  checked.plays_a_person();
  EXPECT_EQ(checked.exit_code, 0);
  EXPECT_EQ(checked.line_of("unplugging"), "passed: readings fail: the device is unplugged");
  EXPECT_EQ(checked.line_of("plugging in"), "passed: readings succeed again");
  EXPECT_THAT(checked.line_of("force when plugged in"), testing::StartsWith("passed: "));
  EXPECT_THAT(checked.line_of("force after that"), testing::StartsWith("passed: "));
  EXPECT_EQ(checked.line_of("buttons"), "passed: pressed: 1");
}

TEST(CheckDeviceCommand, FindsAForceThatComesBackBeforeItIsCommanded) {
  GuidedCheckDevice checked("remembers");
  checked.plays_a_person("remembered");
  EXPECT_EQ(checked.exit_code, 1);
  EXPECT_THAT(checked.line_of("force when plugged in"), testing::StartsWith("failed: "));
}

}  // namespace
}  // namespace forcebound::test
