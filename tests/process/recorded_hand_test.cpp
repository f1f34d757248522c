#include <gtest/gtest.h>

#include "tests/process/loop_checks.hpp"
#include "tests/support/recorded_data.hpp"

namespace forcebound::test {
namespace {

using namespace std::chrono_literals;

constexpr auto kDuration = 10s;

/// One network, a server and a client for each scene:
///
///     client --- relay playing the trace --- server with the sphere
///     client --- relay playing the trace --- server with the plane
TEST(ARecordedHandOnARecordedNetwork, TouchesSphereAndPlaneToTheEnd) {
  const auto hand = recorded_data("motion/hand-guided-a.csv");
  const auto trace = recorded_data("network/5g-urban-n8.csv");
  if (!hand || !trace) GTEST_SKIP() << "no recorded data: set FORCEBOUND_DATA";
  const Words client{"--duration", "10",         "--device",
                     "omni",       "--operator", "replay:" + hand->string() + ",offset_x_m=0.01"};
  const Words relay{"--trace", trace->string(), "--seed", "1"};
  Server sphere_server({"--scene", "sphere"});
  Server plane_server({"--scene", "plane"});
  Relay sphere_relay(sphere_server.address(), relay);
  Relay plane_relay(plane_server.address(), relay);
  Client sphere(sphere_relay.address(), client);
  Client plane(plane_relay.address(), client);
  EXPECT_EQ(sphere.wait(kDuration + 20s), 0);
  EXPECT_EQ(plane.wait(kDuration + 20s), 0);
  for (const Client* done : {&sphere, &plane}) {
    const nlohmann::json summary = done->summary();
    expect_sound(summary, kDuration);
    // The newest force that a network of tens of milliseconds has, and the hand did touch something.
    EXPECT_GT(summary["force_age_ms"]["p50"].get<double>(), 5);
    EXPECT_GT(summary["received"].get<int>(), 1000);
    EXPECT_GT(summary["contact_ticks"].get<int>(), 0);
    EXPECT_TRUE(summary["blackouts"]["count"].is_number());
  }
}

}  // namespace
}  // namespace forcebound::test
