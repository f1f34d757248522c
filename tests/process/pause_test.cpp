#include <gtest/gtest.h>

#include <thread>

#include "tests/process/programs.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;

TEST(AClientStoppedByTheSystem, LetsGoOfTheForceAndRunsOnAfterwards) {
  Server server({"--scene", "sphere"});
  Client client(server.address(), {"--device", "omni", "--operator", "trace-sphere", "--duration", "6"});
  ASSERT_TRUE(client.wait_for("connected"));
  std::this_thread::sleep_for(2s);
  client.signal(SIGSTOP);
  std::this_thread::sleep_for(2s);
  client.signal(SIGCONT);
  EXPECT_EQ(client.wait(20s), 0);
  const nlohmann::json summary = client.summary();
  ASSERT_TRUE(summary.is_object());
  EXPECT_GE(summary["faults"]["released_by_device"], 1);
  EXPECT_GE(summary["period_us"]["max"].get<double>(), 1.9e6);
  EXPECT_GE(summary["late_ticks"], 1);
  // The missed ticks are skipped, not made up for.
  EXPECT_LE(summary["ticks"].get<int>(), 4200);
  EXPECT_GT(summary["ticks"].get<int>(), 3500);
  EXPECT_GE(summary["passivity"]["minimum_J"].get<double>(), -5e-3);
  EXPECT_EQ(summary["faults"]["tick_allocations"], 0);
  // Forces were fresh again: the newest is young at the end.
  EXPECT_LT(summary["force_age_ms"]["p50"].get<double>(), 20);
}

}  // namespace
}  // namespace forcebound::test
