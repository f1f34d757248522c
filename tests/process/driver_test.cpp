#include <gmock/gmock.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "tests/process/device_driver.hpp"
#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

/// Until there is such a file; false: the program ended without it.
bool wait_for_file(Process& program, const std::string& file) {
  while (!std::filesystem::exists(file)) {
    if (program.wait(10ms)) return false;
  }
  return true;
}

/// A client in a weight's field, which is a force at any place, on a device whose driver goes wrong when it is told to.
class FaultyDriver : public testing::Test {
 protected:
  void begin(const std::string& fault) {
    const DriversForTests drivers;
    client.emplace(server.address(), Words{"--quiet", "--law", "none", "--device",
                                           "faulty:fault=" + fault + ",control=" + folder.path().string()});
    ASSERT_TRUE(wait_for_file(*client, folder.file("forced"))) << client->err();
  }

  /// How many forces there were after good readings and after bad ones.
  [[nodiscard]] std::pair<long, long> forces() const {
    std::istringstream numbers(content(folder.file("forces")));
    std::pair<long, long> counts{-1, -1};
    numbers >> counts.first >> counts.second;
    return counts;
  }

  void expect_no_force_while(const std::string& file, const std::string& why, const std::string& counted) {
    write_file(folder.file(file), "");
    EXPECT_TRUE(client->wait_for("no readings of the device, and no force until there are: " + why));
    std::filesystem::remove(folder.file(file));
    EXPECT_TRUE(client->wait_for("the device is back after"));
    EXPECT_EQ(client->stop(), client->expected_end()) << client->err();
    const auto [after_good, after_bad] = forces();
    EXPECT_GT(after_good, 0);
    EXPECT_EQ(after_bad, 0) << "a force without a reading";
    EXPECT_THAT(unwrapped(client->out()), HasSubstr(counted));
  }

  /// The client ends by itself, says so, and has stopped the device.
  void expect_end_of_a_driver_that_hangs() {
    write_file(folder.file("fault"), "");
    EXPECT_EQ(client->wait(120s), 1) << client->err();
    EXPECT_THAT(client->err(), HasSubstr("the driver of device 'three rails' has not returned from a call for 2 s; the "
                                         "device was stopped; the client ends"));
    EXPECT_TRUE(std::filesystem::exists(folder.file("stopped"))) << "by the watchdog";
  }

  Server server{Words{"--scene", "gravity"}};
  TemporaryFolder folder;
  std::optional<Client> client;
};

TEST_F(FaultyDriver, PositionsThatAreNoNumbersAreNoForce) {
  begin("nan");
  expect_no_force_while("fault", "its reading has numbers that are not finite",
                        " with numbers that are not finite: no force");
}

TEST_F(FaultyDriver, TimesThatRunBackwardsAreNoForce) {
  begin("backwards");
  expect_no_force_while("fault", "its readings run backwards in time", " that ran backwards in time: no force");
}

TEST_F(FaultyDriver, TimesAMillisecondInTheFutureAreNoForce) {
  begin("ahead");
  expect_no_force_while("fault", "its reading was latched in the future", " latched in the future: no force");
}

TEST_F(FaultyDriver, ReadingsThatFailAreNoForce) {
  begin("fails");
  expect_no_force_while("fault", "no reading", " failed device reading");
}

TEST_F(FaultyDriver, ADeviceThatIsUnpluggedHasNoForce) {
  begin("none");
  expect_no_force_while("unplugged", "the device is unplugged", " failed device reading");
}

TEST_F(FaultyDriver, AReadThatDoesNotReturnEndsTheClientAndStopsTheDevice) {
  begin("hang-read");
  expect_end_of_a_driver_that_hangs();
}

TEST_F(FaultyDriver, ACommandThatDoesNotReturnEndsTheClientAndStopsTheDevice) {
  begin("hang-push");
  expect_end_of_a_driver_that_hangs();
}

TEST_F(FaultyDriver, TheClientEndsIfStopDoesNotReturnEither) {
  begin("hang-stop");
  write_file(folder.file("fault"), "");
  EXPECT_EQ(client->wait(120s), 1) << client->err();
  EXPECT_THAT(client->err(),
              AllOf(HasSubstr("has not returned from a call"), HasSubstr("its stop does not return either")));
}

struct Crash {
  const char* fault;
  const char* words;
  const char* then = "; it was stopped";
};

/// The client ends with a line that names the driver and what it was asked for, an exit code of its own, and no force.
class ADriverThatCrashes : public FaultyDriver, public testing::WithParamInterface<Crash> {};

TEST_P(ADriverThatCrashes, IsStoppedAndNamedWithTheCall) {
  const std::string words = std::string("driver 'faulty' ") + GetParam().words + GetParam().then;
  begin(GetParam().fault);
  write_file(folder.file("fault"), "");
  EXPECT_EQ(client->wait(120s), kDriverCrashed) << client->err();
  EXPECT_THAT(client->err(), HasSubstr(words));
  EXPECT_TRUE(std::filesystem::exists(folder.file("stopped")));
}

INSTANTIATE_TEST_SUITE_P(WhileAForceIsOn, ADriverThatCrashes,
                         testing::Values(Crash{"crash-push", "crashed in command (Segmentation fault)"},
                                         Crash{"crash", "crashed in read (Aborted)"},
                                         Crash{"overflow", "crashed in read (Segmentation fault)"},
                                         Crash{"exit", "ended the program by exit() in command"},
                                         Crash{"crash-thread", "crashed in a thread of its own (Segmentation fault)"}),
                         [](const auto& tried) {
                           std::string name = tried.param.fault;
                           std::erase(name, '-');
                           return name;
                         });

TEST_F(FaultyDriver, ThatCrashesInStopIsNamedAndMayLeaveAForce) {
  begin("crash-stop");
  client->signal(SIGTERM);
  EXPECT_EQ(client->wait(120s), kDriverCrashed) << client->err();
  EXPECT_THAT(client->err(), HasSubstr("driver 'faulty' crashed in stop (Segmentation fault); its stop crashed too, so "
                                       "that a force may be left"));
}

TEST_F(FaultyDriver, ThatCrashesInCloseIsNamedAfterItWasStopped) {
  begin("crash-close");
  client->signal(SIGTERM);
  EXPECT_EQ(client->wait(120s), kDriverCrashed) << client->err();
  EXPECT_THAT(client->err(), HasSubstr("driver 'faulty' crashed in close (Segmentation fault)\n"));
  EXPECT_TRUE(std::filesystem::exists(folder.file("stopped")));
}

TEST(DriverOfTheClient, ThatCrashesBeforeAnyForceIsNamedWithTheCall) {
  for (const auto& [fault, words] :
       {std::pair("crash-reopen", "crashed in open (Segmentation fault)\n"),
        std::pair("crash-start", "crashed in start (Segmentation fault); it was stopped\n")}) {
    const DriversForTests drivers;
    const TemporaryFolder folder;
    const Ran client = run(kClient, {"--server", "127.0.0.1:9", "--device",
                                     std::string("faulty:fault=") + fault + ",control=" + folder.path().string()});
    EXPECT_EQ(client.exit_code, kDriverCrashed) << client.err;
    EXPECT_THAT(client.err, HasSubstr(std::string("forcebound-client: driver 'faulty' ") + words));
  }
}

/// What the client says of a device that it cannot have, in one line.
std::string refusal_of(const std::string& device) {
  const Ran client = run(kClient, {"--server", "127.0.0.1:9", "--device", device});
  EXPECT_EQ(client.exit_code, 1) << client.out << client.err;
  EXPECT_EQ(lines(client.err), 1U) << client.err;
  EXPECT_EQ(client.out, "");
  return client.err;
}

TEST(DriverOfTheClient, IsRefusedInOneLine) {
  const DriversForTests drivers;
  EXPECT_THAT(refusal_of("newer"), HasSubstr("has interface 99, this program has 1: build it with this program's "
                                             "forcebound_device.h"));
  EXPECT_THAT(refusal_of("mute"), HasSubstr("lacks the function 'command'"));
  EXPECT_THAT(refusal_of("empty"), HasSubstr("is no driver"));
  EXPECT_THAT(refusal_of("crashing"), AllOf(HasSubstr("when it was asked to open its device"), HasSubstr("Aborted")));
  EXPECT_THAT(refusal_of("slider:axes=9"), HasSubstr("'axes=9' is not accepted; accepted are axes=1 to 3"));
  // It is known only once the client starts.
  const Ran client = run(kClient, {"--server", "127.0.0.1:9", "--device", "slider:fault=start"});
  EXPECT_EQ(client.exit_code, 1);
  EXPECT_THAT(client.err, testing::EndsWith("forcebound-client: driver 'slider': no power\n"));
}

TEST(DriverOfTheClient, SaysWhatItLookedForWhereAndHowToGetIt) {
  ::setenv("FORCEBOUND_DEVICE_PATH", FORCEBOUND_DRIVERS, 1);
  EXPECT_THAT(refusal_of("force-dimension:library=/nonexistent/libdhd.so"),
              AllOf(HasSubstr("/nonexistent/libdhd.so"), HasSubstr("forcedimension.com")));
  EXPECT_THAT(refusal_of("openhaptics:library=/nonexistent/libHD.so"),
              AllOf(HasSubstr("/nonexistent/libHD.so"), HasSubstr("3dsystems.com")));
  const std::string address = free_address();
  EXPECT_THAT(refusal_of("haply:address=" + address),
              AllOf(HasSubstr("no Inverse service at " + address), HasSubstr("docs.haply.co")));
  ::unsetenv("FORCEBOUND_DEVICE_PATH");
}

}  // namespace
}  // namespace forcebound::test
