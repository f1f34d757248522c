#include <gmock/gmock.h>
#include <sched.h>

#include <cstring>
#include <filesystem>
#include <string>
#include <thread>

#include "forcebound/time/real_time.hpp"
#include "tests/process/programs.hpp"
#include "tests/support/auto_wall.hpp"
#include "tests/support/becomes_true.hpp"

namespace forcebound::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// The load does not wait for the answers to its Byes.
void await_closings(const Server& server, std::size_t sessions) {
  EXPECT_TRUE(becomes_true([&] { return occurrences(server.err(), " ended its session") >= sessions; }));
}

TEST(LabLoad, IsAnsweredByARealServerAndEndsItsSessions) {
  Server server({"--scene", "sphere"});
  const TemporaryFolder folder;
  const Ran lab = run(kLab, {"load", "--server", server.address(), "--clients", "5", "--seconds", "0.3", "--json",
                             folder.file("load.json")});
  ASSERT_EQ(lab.exit_code, 0) << lab.err;
  EXPECT_THAT(lab.out, HasSubstr("5 clients: "));
  const auto result = nlohmann::json::parse(content(folder.file("load.json")));
  EXPECT_EQ(result["clients"], 5);
  EXPECT_EQ(result["sent"].get<int>() + result["unsent"].get<int>(), 1500);
  EXPECT_GT(result["sent"].get<int>(), result["lost"].get<int>());
  EXPECT_GT(result["service_us"]["p50"].get<double>(), 0);
  EXPECT_LE(result["service_us"]["p50"].get<double>(), result["service_us"]["max"].get<double>());
  EXPECT_LE(result["service_us"]["p50"].get<double>(), result["read_us"]["p50"].get<double>());
  await_closings(server, 5);
  EXPECT_EQ(server.stop(), 0);
  EXPECT_EQ(counted(server.out(), "sessions", "opened"), 5U);
  EXPECT_EQ(counted(server.out(), "sessions", "ended by the client"), 5U);
}

TEST(LabLoad, IsAnsweredByTwoWorkersAtOneAddress) {
  Server server({"--scene", "sphere", "--workers", "2"});
  const Ran lab =
      run(kLab, {"load", "--server", server.address(), "--clients", "16", "--sockets", "16", "--seconds", "0.3"});
  ASSERT_EQ(lab.exit_code, 0) << lab.err;
  EXPECT_THAT(lab.out, HasSubstr("16 clients: "));
  await_closings(server, 16);
  EXPECT_EQ(server.stop(), 0);
  EXPECT_EQ(counted(server.out(), "sessions", "opened"), 16U);
  EXPECT_EQ(counted(server.out(), "sessions", "ended by the client"), 16U);
  EXPECT_GT(counted(server.out(), "forces", "sent"), 0U);
  EXPECT_THAT(server.out(), Not(HasSubstr("handed over"))) << "the system steers";
}

// As systemd starts a service with CPUSchedulingResetOnFork: no thread inherits the first one's scheduling.
TEST(Workers, HaveSchedFifoEach) {
  constexpr int kAsTheServer = 40;
  constexpr const char* kChrt = "/usr/bin/chrt";
  int refused = 0;
  std::thread([&] { refused = time::ask_for_first_in_first_out(kAsTheServer); }).join();
  if (refused != 0) GTEST_SKIP() << "SCHED_FIFO is not granted here: " << std::strerror(refused);
  if (!std::filesystem::exists(kChrt)) GTEST_SKIP() << "no chrt, which is in the package util-linux";
  Process server(kChrt, {"--reset-on-fork", "--fifo", "1", kServer, "--listen", "127.0.0.1:0", "--scene", "sphere",
                         "--workers", "3", "--realtime"});
  ASSERT_TRUE(server.wait_for("listening on "));
  const auto threads_in_real_time = [&] {
    int all = 0;
    for (const auto& task : std::filesystem::directory_iterator("/proc/" + std::to_string(server.pid()) + "/task")) {
      all += (sched_getscheduler(std::stoi(task.path().filename())) & ~SCHED_RESET_ON_FORK) == SCHED_FIFO ? 1 : 0;
    }
    return all;
  };
  // Each asks for itself once it runs.
  EXPECT_TRUE(becomes_true([&] { return threads_in_real_time() == 3; }));
  EXPECT_EQ(server.stop(), 0);
}

TEST(LabLoad, AsksForTheSceneAndForLocalModelsAsAClientDoes) {
  const TemporaryFolder folder;
  write_file(folder.file("far.toml"), R"(
[scene]
name = "far"
description = "Tissue that bends far."
degrees_of_freedom = 3
[[tissue]]
name = "pad"
shape = { kind = "block", center_m = [0, 0, -0.01], size_m = [0.04, 0.04, 0.02], cells = [2, 2, 1] }
held = { through_m = [0, 0, -0.0199], normal = [0, 0, 1] }
young_Pa = 1e4
poisson = 0.3
large_motion = true
)");
  Server server({"--scene", folder.file("far.toml")});
  const auto rendering_of = [&](const std::string& scene) {
    const Ran lab =
        run(kLab, {"load", "--server", server.address(), "--scene", scene, "--height", "-0.003", "--clients", "2",
                   "--seconds", "0.2", "--rendering", "local", "--json", folder.file("load.json")});
    EXPECT_EQ(lab.exit_code, 0) << lab.err;
    EXPECT_THAT(unwrapped(lab.out), HasSubstr("local rendering of scene " + scene));
    return nlohmann::json::parse(content(folder.file("load.json")))["rendering"];
  };
  const auto mesh = rendering_of("dome");
  EXPECT_EQ(mesh["asked"], "local");
  EXPECT_GT(mesh["scene_pieces"].get<int>(), 0);
  EXPECT_EQ(mesh["modelled"], 0) << "all of it runs at the client";
  const auto tissue = rendering_of("far");
  EXPECT_EQ(tissue["scene_pieces"], 0) << "none of it runs at the client";
  EXPECT_GT(tissue["modelled"].get<double>(), 0);
  EXPECT_EQ(server.stop(), 0);
  EXPECT_GT(counted(server.out(), "pieces of scenes", "sent"), 0U);
}

TEST(LabLoad, TellsItsRoundTripToASceneThatPicksItsAccuracyByIt) {
  const TemporaryFolder folder;
  write_file(folder.file("auto_wall.toml"), kAutoWall);
  Server server({"--scene", folder.file("auto_wall.toml")});
  const Ran lab = run(kLab, {"load", "--server", server.address(), "--clients", "2", "--seconds", "0.1"});
  EXPECT_EQ(lab.exit_code, 0) << lab.err;
  EXPECT_EQ(server.stop(), 0);
  EXPECT_EQ(counted(server.out(), "sessions", "opened"), 2U);
}

TEST(LabLoad, FindsAMostNotAboveItsLimit) {
  Server server({"--scene", "sphere"});
  const Ran lab = run(kLab, {"load", "--server", server.address(), "--find-most", "--limit", "2", "--seconds", "0.1"});
  // How many get their answers in time is the machine's: none, one or two.
  EXPECT_THAT(lab.out + lab.err, testing::ContainsRegex("most: [12] client|not even one client"));
  EXPECT_EQ(lab.exit_code == 0, lab.out.find("most: ") != std::string::npos);
  EXPECT_THAT(lab.out, testing::ContainsRegex("(^|\n) *2 clients"));
  EXPECT_THAT(lab.out, testing::Not(testing::ContainsRegex("(^|\n) *[3-9] clients")));
}

TEST(LabLoad, PassesOnWhyTheServerRefuses) {
  Server server({"--scene", "circle"});
  const Ran lab = run(kLab, {"load", "--server", server.address(), "--dof", "3", "--seconds", "0.1"});
  EXPECT_EQ(lab.exit_code, 1);
  EXPECT_THAT(lab.err, HasSubstr("degrees of freedom"));
}

TEST(LabLoad, GivesUpWithoutAnAnswer) {
  const Ran lab = run(kLab, {"load", "--server", free_address(), "--seconds", "0.1"});
  EXPECT_EQ(lab.exit_code, 1);
  EXPECT_THAT(lab.err, testing::AllOf(HasSubstr("no answer from 127.0.0.1:"), HasSubstr("port unreachable (ICMP)")));
}

}  // namespace
}  // namespace forcebound::test
