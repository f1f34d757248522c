#include <gmock/gmock.h>

#include <csignal>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/process/leader.hpp"
#include "tests/process/programs.hpp"
#include "tests/support/becomes_true.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A machine that gives the loop no time meanwhile does not stop the robot.
constexpr const char* kPatient = "hold=0.4";

/// What `--follower` takes for the arm of the tests.
std::string driven(const std::string& settings, const std::string& driver = "arm") {
  return std::string("driver:") + FORCEBOUND_TEST_DRIVERS + "/robots/forcebound-device-" + driver + ".so:" + settings;
}

/// A robot behind a driver that goes wrong when it is told to, and its leader.
class FaultyRobot : public testing::Test {
 protected:
  void begin(const std::string& fault) {
    server.emplace(
        Words{"--follower", driven("fault=" + fault + ",control=" + folder.path().string() + "," + kPatient)});
    leader.emplace(server->address(), hand.options());
    ASSERT_TRUE(leader->wait_for("the robot follows")) << server->err();
    // Until the hand moves there is no torque.
    ASSERT_TRUE(becomes_true([&] { return std::filesystem::exists(folder.file("pushed")); })) << server->err();
  }
  void go_wrong() { write_file(folder.file("fault"), ""); }

  /// How many torques there were after good readings and after bad ones.
  [[nodiscard]] std::pair<long, long> torques() const {
    std::istringstream numbers(content(folder.file("torques")));
    std::pair<long, long> counts{-1, -1};
    numbers >> counts.first >> counts.second;
    return counts;
  }

  void expect_both_end_well() {
    EXPECT_EQ(leader->stop(), leader->expected_end()) << leader->err();
    EXPECT_GE(leader->summary()["passivity"]["minimum_J"], kPassiveLeast_J);
    EXPECT_EQ(server->stop(), 0) << server->err();
    const std::string totals = unwrapped(server->out());
    const auto least_mJ = least_port_millijoules(totals);
    ASSERT_TRUE(least_mJ) << totals;
    EXPECT_GE(*least_mJ, kPassiveLeast_mJ);
    EXPECT_THAT(totals, Not(HasSubstr("allocation")));
  }

  void expect_failure_and_return(const std::string& fault, const std::string& why) {
    begin(fault);
    go_wrong();
    ASSERT_TRUE(server->wait_for(" -> failed")) << server->err();
    EXPECT_TRUE(leader->wait_for("the robot refuses")) << leader->err();
    EXPECT_TRUE(server->wait_for(": the robot refuses: " + why + "\n")) << server->err();
    std::filesystem::remove(folder.file("fault"));
    EXPECT_TRUE(server->wait_for("failed -> stopped")) << server->err();
    EXPECT_TRUE(leader->wait_for("the robot has stopped")) << leader->err();
    expect_both_end_well();
    const auto [after_good, after_bad] = torques();
    EXPECT_GT(after_good, 0);
    EXPECT_EQ(after_bad, 0) << "a torque without a reading";
  }

  /// The server ends by itself, in a line that says so, and tells its leader why.
  void expect_end(const std::string& why, int exit_code = 1) {
    go_wrong();
    EXPECT_EQ(server->wait(), exit_code) << server->err();
    EXPECT_THAT(server->err(), HasSubstr(why));
    EXPECT_TRUE(leader->wait_for("the server ended the session")) << leader->err();
    EXPECT_TRUE(has_in_order(leader->err(),
                             {"the robot refuses: the server's log has the reason", "the server ended the session"}));
    EXPECT_EQ(leader->stop(), leader->expected_end()) << leader->err();
    EXPECT_GE(leader->summary()["passivity"]["minimum_J"], kPassiveLeast_J);
  }

  RecordedHand hand;
  TemporaryFolder folder;
  std::optional<Server> server;
  std::optional<Client> leader;
};

TEST(ARobotBehindADriver, FollowsItsLeaderAndBothSidesArePassive) {
  const RecordedHand hand;
  Server server({"--follower", driven(kPatient)});
  Client client(server.address(), and_also(hand.options(), {"--duration", "7", "--once"}));
  EXPECT_EQ(client.wait(), 0);
  EXPECT_TRUE(has_in_order(client.err(), {"the robot waits: keep the device still", "the robot follows"}));
  const nlohmann::json summary = client.summary();
  EXPECT_GT(summary["follower"]["seconds"]["following"], 0);
  if (was_led_all_the_time(server)) {
    EXPECT_GT(summary["force_N"]["max"], 1) << "the floor is felt";
  }
  EXPECT_GE(summary["passivity"]["minimum_J"], kPassiveLeast_J);

  EXPECT_EQ(server.stop(), 0);
  EXPECT_TRUE(has_in_order(server.err(), {"robot: arm 7: 7 joints", "waiting -> following", "-> stopping",
                                          "the leader has left", "stopping -> stopped"}));
  const std::string totals = unwrapped(server.out());
  EXPECT_THAT(totals, AllOf(HasSubstr("position-force, law fba-exact"), HasSubstr("at the end at rest"),
                            Not(HasSubstr("allocation")), Not(HasSubstr("task:"))));
  const auto least_mJ = least_port_millijoules(totals);
  ASSERT_TRUE(least_mJ) << totals;
  EXPECT_GE(*least_mJ, kPassiveLeast_mJ);
}

TEST_F(FaultyRobot, FailsWherePositionsAreNoNumbers) {
  expect_failure_and_return("nan", "its reading has numbers that are not finite");
}

TEST_F(FaultyRobot, FailsWhereTimesRunBackwards) {
  expect_failure_and_return("backwards", "its readings run backwards in time");
}

TEST_F(FaultyRobot, FailsWhereReadingsDoNamingTheDriversReason) {
  expect_failure_and_return("fails", "joint 4 is too hot");
}

TEST_F(FaultyRobot, FailsWhenItIsUnplugged) { expect_failure_and_return("unplugged", "the robot is unplugged"); }

TEST_F(FaultyRobot, ThatDoesNotReturnFromACallForAWhileIsStoppedAndItsLeaderTold) {
  begin("slow");
  go_wrong();
  EXPECT_TRUE(leader->wait_for("the robot refuses")) << leader->err();
  std::filesystem::remove(folder.file("fault"));
  // A machine so slow that it took 2 s to come here has ended the server.
  if (!server->wait_for("-> stopped")) {
    EXPECT_EQ(server->wait(), 1);
    GTEST_SKIP() << "the machine is too slow";
  }
  EXPECT_TRUE(std::filesystem::exists(folder.file("stopped")));
  EXPECT_THAT(server->err(), HasSubstr("its driver did not return from a call"));
  expect_both_end_well();
}

TEST_F(FaultyRobot, WhoseReadDoesNotReturnIsStoppedAndTheServerEnds) {
  begin("hang-read");
  expect_end("has not returned from a call for 2 s; the robot was stopped; the server ends");
  EXPECT_TRUE(std::filesystem::exists(folder.file("stopped")));
}

TEST_F(FaultyRobot, WhoseCommandDoesNotReturnIsStoppedAndTheServerEnds) {
  begin("hang-command");
  expect_end("has not returned from a call for 2 s; the robot was stopped; the server ends");
  EXPECT_TRUE(std::filesystem::exists(folder.file("stopped")));
}

TEST_F(FaultyRobot, WhoseStopDoesNotReturnEitherEndsTheServer) {
  begin("hang-stop");
  expect_end("has not returned from a call for 2 s; its stop does not return either, so that a torque may be left");
}

TEST_F(FaultyRobot, WhoseDriverCrashesIsStoppedAndTheServerEnds) {
  begin("crash");
  expect_end("arm 7: driver 'arm' crashed in read_robot (Segmentation fault); it was stopped; the server ends",
             kDriverCrashed);
  EXPECT_TRUE(std::filesystem::exists(folder.file("stopped")));
}

TEST_F(FaultyRobot, WhoseDriverCrashesInACommandIsStoppedAndTheServerEnds) {
  begin("crash-command");
  expect_end("driver 'arm' crashed in command_robot (Segmentation fault); it was stopped", kDriverCrashed);
  EXPECT_TRUE(std::filesystem::exists(folder.file("stopped")));
}

TEST_F(FaultyRobot, WhoseDriverCrashesInAThreadOfItsOwnIsStoppedAndTheServerEnds) {
  begin("crash-thread");
  expect_end("driver 'arm' crashed in a thread of its own (Segmentation fault); it was stopped", kDriverCrashed);
  EXPECT_TRUE(std::filesystem::exists(folder.file("stopped")));
}

TEST_F(FaultyRobot, ThatStopsByItselfSaysSo) {
  begin("stops");
  go_wrong();
  ASSERT_TRUE(server->wait_for("-> stopped")) << server->err();
  EXPECT_THAT(server->err(), HasSubstr("the robot stopped by itself: the robot stopped itself"));
  EXPECT_TRUE(leader->wait_for("the robot has stopped")) << leader->err();
  expect_both_end_well();
}

TEST_F(FaultyRobot, IsStoppedWhenItsLeaderIsKilledAndFollowsTheNext) {
  begin("none");
  leader->signal(SIGKILL);
  ASSERT_TRUE(leader->wait());
  ASSERT_TRUE(server->wait_for("stopping -> stopped")) << server->err();
  EXPECT_TRUE(std::filesystem::exists(folder.file("stopped")));
  leader.emplace(server->address(), hand.options());
  EXPECT_TRUE(leader->wait_for("the robot has stopped: keep the device still")) << leader->err();
  EXPECT_TRUE(leader->wait_for("the robot follows")) << leader->err();
  expect_both_end_well();
}

TEST_F(FaultyRobot, WhoseServerIsKilledLeavesItsLeaderWithoutAForce) {
  begin("none");
  server->signal(SIGKILL);
  ASSERT_TRUE(leader->wait_for("old: zero force")) << leader->err();
  EXPECT_EQ(leader->stop(), leader->expected_end());
  EXPECT_GE(leader->summary()["passivity"]["minimum_J"], kPassiveLeast_J);
}

TEST_F(FaultyRobot, RefusesASecondLeaderNamingTheFirst) {
  begin("none");
  Client second(server->address(), {"--device", "omni", "--operator", "wave", "--once", "--duration", "10"});
  const std::optional<int> ended = second.wait();
  if (ended != 5 && !was_led_all_the_time(*server))
    GTEST_SKIP() << "the machine is too slow: the first leader was silent";
  EXPECT_EQ(ended, 5);
  EXPECT_THAT(second.err(), HasSubstr("the robot is led by 'firm-3dof': it follows one leader at a time"));
  expect_both_end_well();
}

TEST(ARobotBehindADriver, IsRefusedInALineWhereItCannotBe) {
  const auto refused = [](const Words& words, int exit_code) {
    const Ran ran = run(kServer, words);
    EXPECT_EQ(ran.exit_code, exit_code) << ran.err;
    EXPECT_LE(lines(ran.err), 2U) << ran.err;
    return ran.err;
  };
  EXPECT_THAT(refused({"--follower", driven(""), "--task", "plug"}, 2), HasSubstr("--task is for simulated robots"));
  EXPECT_THAT(refused({"--follower", "driver:/nonexistent.so"}, 1), HasSubstr("there is no such file"));
  EXPECT_THAT(refused({"--follower", driven("fault=open")}, 1), HasSubstr("no arm at 192.0.2.1: is its power on?"));
  EXPECT_THAT(refused({"--follower", driven("fault=start")}, 1), HasSubstr("its emergency stop is pressed"));
  EXPECT_THAT(refused({"--follower", driven("fault=crash-open")}, 1), HasSubstr("Segmentation fault"));
  EXPECT_THAT(refused({"--follower", driven("sensor=0")}, 2),
              HasSubstr("needs a force sensor, and robot 'arm 7' has none: position-position needs none"));
  EXPECT_THAT(refused({"--follower", "nowhere.toml"}, 1), HasSubstr("nowhere.toml"));
}

}  // namespace
}  // namespace forcebound::test
