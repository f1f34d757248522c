#include "forcebound/device/tick_rate.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>

#include "forcebound/device/device_registry.hpp"
#include "forcebound/device/load_device.hpp"

namespace forcebound::device {
namespace {

std::string refusal(const control::DeviceFacts& facts, double rate_Hz) {
  try {
    (void)at_tick_rate(facts, rate_Hz);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

TEST(TickRate, ChangesNothingButThePeriod) {
  const control::DeviceFacts own = load_device("wall-1dof").facts;
  for (const double rate_Hz : std::array{500.0, 1000.0, 2000.0, 4000.0}) {
    const control::DeviceFacts facts = at_tick_rate(own, rate_Hz);
    EXPECT_DOUBLE_EQ(facts.period_s, 1 / rate_Hz);
    EXPECT_EQ(facts.hold_s_max, own.hold_s_max);
    EXPECT_EQ(facts.damping, own.damping);
    EXPECT_EQ(facts.force_N_max, own.force_N_max);
    EXPECT_EQ(facts.latency_s, own.latency_s);
  }
}

TEST(TickRate, IsTheDevicesOwnWhereNoneIsSaid) {
  control::DeviceFacts facts = load_device("wall-1dof").facts;
  facts.period_s = 0.01;
  EXPECT_EQ(at_tick_rate(facts, 0).period_s, 0.01);
}

TEST(TickRate, IsRefusedOutsideOfWhatALoopRunsAt) {
  const control::DeviceFacts facts = load_device("wall-1dof").facts;
  EXPECT_EQ(refusal(facts, 499), "ticks per second must be from 500 to 4000, got 499");
  EXPECT_EQ(refusal(facts, 4001), "ticks per second must be from 500 to 4000, got 4001");
  EXPECT_NE(refusal(facts, -1000), "");
  EXPECT_NE(refusal(facts, std::numeric_limits<double>::quiet_NaN()), "");
}

TEST(TickRate, IsRefusedIfNoForceWouldLastATick) {
  control::DeviceFacts facts = load_device("wall-1dof").facts;
  facts.hold_s_max = 1e-3;
  EXPECT_EQ(refusal(facts, 1000), "");
  EXPECT_EQ(refusal(facts, 500),
            "device 'wall-1dof' holds a force for 1 ms, less than a tick of 2 ms: at least 1000 ticks per second are "
            "accepted, got 500");
  facts.releases = false;
  EXPECT_EQ(refusal(facts, 500), "");
}

TEST(TickRate, IsThatOfASimulatedDeviceThatIsMade) {
  const auto device =
      DeviceRegistry::standard().make({.device = "wall-1dof", .hand = "press", .rate_Hz = kTickRateMost_Hz});
  EXPECT_DOUBLE_EQ(device->facts().period_s, 1 / kTickRateMost_Hz);
}

}  // namespace
}  // namespace forcebound::device
