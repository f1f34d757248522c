#include <gtest/gtest.h>

#include "tests/process/loop_checks.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;

constexpr auto kDuration = 10s;

/// Two networks, a server and a client for each:
///
///     client --- relay with the urban trace's beginning --------------------------- server with the sphere
///     client --- relay with the rural trace's worst moment, a round trip of 12 s --- server with the plane
TEST(ARecordedHandOnARecordedNetwork, TouchesSphereAndPlaneToTheEnd) {
  const auto hand = recorded_data("motion/hand-guided-a.csv");
  const auto urban = recorded_data("network/5g-urban-n8.csv");
  const auto rural = recorded_data("network/5g-rural-n8.csv");
  if (!hand || !urban || !rural) GTEST_SKIP() << "no recorded data: set FORCEBOUND_DATA";
  const TemporaryFolder folder;
  write_trace_after(*rural, 78s, folder.file("worst.csv"));
  const Words client{"--duration", "10",         "--device",
                     "omni",       "--operator", "replay:" + hand->string() + ",offset_x_m=0.01"};
  Server sphere_server({"--scene", "sphere"});
  Server plane_server({"--scene", "plane"});
  Relay sphere_relay(sphere_server.address(), {"--trace", urban->string()});
  Relay plane_relay(plane_server.address(), {"--trace", folder.file("worst.csv")});
  Client sphere(sphere_relay.address(), client);
  Client plane(plane_relay.address(), client);
  EXPECT_EQ(sphere.wait(kDuration + 20s), 0);
  EXPECT_EQ(plane.wait(kDuration + 20s), 0);
  for (const Client* done : {&sphere, &plane}) {
    const nlohmann::json summary = done->summary();
    expect_sound(summary, kDuration);
    EXPECT_GT(summary["force_age_ms"]["p50"].get<double>(), 5);
    EXPECT_GT(summary["received"], 0);
    EXPECT_GT(summary["contact_ticks"], 0);
  }
  EXPECT_GT(plane.summary()["late_force"]["fading_ticks"], 0);
  EXPECT_GT(plane.summary()["late_force"]["dropped_ticks"], 0);
  EXPECT_GT(plane.summary()["force_age_ms"]["max"], 2000);
  EXPECT_GE(plane.summary()["blackouts"]["count"], 1);
}

}  // namespace
}  // namespace forcebound::test
