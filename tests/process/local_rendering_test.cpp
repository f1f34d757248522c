#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <optional>

#include "tests/process/passive.hpp"
#include "tests/process/programs.hpp"
#include "tests/process/recorded_run.hpp"
#include "tests/support/becomes_true.hpp"
#include "tests/tools/temporary_folder.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;

/// A client at the sphere, behind 50 ms each way, with what it wrote.
nlohmann::json felt(const std::string& server, const std::string& cache) {
  Client client(server, {"--device", "omni", "--operator", "trace-sphere", "--duration", "4", "--rendering", "local",
                         "--scene-cache", cache});
  EXPECT_EQ(client.wait(30s), 0) << client.err();
  return client.summary();
}

TEST(LocalRendering, RunsTheSceneAtTheClientAndHasItFromTheCacheTheNextTime) {
  const TemporaryFolder folder;
  Server server({"--scene", "sphere"});
  Relay relay(server.address(), {"--netem", "delay 50ms 10ms loss 5%"});
  for (int visit = 0; visit < 2; ++visit) {
    const nlohmann::json summary = felt(relay.address(), folder.file("cache"));
    ASSERT_TRUE(summary.is_object());
    EXPECT_GT(summary["rendering"]["at_client"].get<double>(), 0);
    EXPECT_EQ(summary["rendering"]["scenes_from_cache"], visit);
    EXPECT_EQ(summary["faults"]["scenes_refused"], 0);
    EXPECT_EQ(summary["faults"]["tick_allocations"], 0);
    EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), kPassive_J);
  }
}

TEST(LocalRendering, GoesOnWhileTheServerIsDeadAndWithTheNextOne) {
  std::optional<Server> server;
  server.emplace(Words{"--scene", "sphere"});
  const std::string address = server->address();
  RecordedClient client(address, {"--device", "omni", "--operator", "trace-sphere", "--rendering", "local"});
  ASSERT_TRUE(client.wait_for("the scene has arrived"));
  server->stop(SIGKILL);
  const auto killed = steady_now();
  EXPECT_TRUE(client.wait_for_tick([&](const auto& tick) { return tick.time > killed + 4s && is_pressed(tick); }));
  server.emplace(Words{"--scene", "sphere"}, address);
  EXPECT_TRUE(becomes_true([&] { return occurrences(client.err(), "connected; simulated:") == 2; })) << client.err();
  EXPECT_EQ(client.stop(), client.expected_end()) << client.err();
  const nlohmann::json summary = client.summary();
  ASSERT_TRUE(summary.is_object());
  EXPECT_EQ(summary["faults"]["reconnects"], 1);
  EXPECT_GT(summary["rendering"]["at_client"].get<double>(), 0);
  EXPECT_EQ(summary["faults"]["tick_allocations"], 0);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), kPassive_J);
}

//   hand on tissue -- client ==( 50 ms each way, jitter, loss )== server
TEST(LocalRendering, RunsTissueAtTheClient) {
  Server server({"--scene", "pad"});
  Relay relay(server.address(), {"--netem", "delay 50ms 10ms loss 5%"});
  RecordedClient client(relay.address(),
                        {"--device", "firm-3dof", "--operator",
                         "stroke:depth_m=0.006,length_m=0.02,stiffness_N_per_m=1000", "--rendering", "local"});
  ASSERT_TRUE(client.wait_for("the scene has arrived")) << client.err();
  EXPECT_TRUE(client.wait_for_tick(
      [](const auto& tick) { return tick.rendering == record::ForceOrigin::at_client && is_pressed(tick); }));
  EXPECT_EQ(client.stop(), client.expected_end()) << client.err();
  const nlohmann::json summary = client.summary();
  ASSERT_TRUE(summary.is_object());
  EXPECT_GT(summary["rendering"]["at_client"].get<double>(), 0);
  EXPECT_EQ(summary["faults"]["tick_allocations"], 0);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), kPassive_J);
}

TEST(LocalRendering, GoesOnWithoutACacheWhereItCannotBeWritten) {
  const TemporaryFolder folder;
  write_file(folder.file("file"), "not a folder");
  Server server({"--scene", "sphere"});
  const nlohmann::json summary = felt(server.address(), folder.file("file"));
  ASSERT_TRUE(summary.is_object());
  EXPECT_GT(summary["rendering"]["at_client"].get<double>(), 0);
  EXPECT_NE(summary["faults"]["notes"].dump().find("scene cache: "), std::string::npos);
}

}  // namespace
}  // namespace forcebound::test
