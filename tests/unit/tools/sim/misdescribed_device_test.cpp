#include "tests/tools/sim/misdescribed_device.hpp"

#include <gtest/gtest.h>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"

namespace forcebound::sim {
namespace {

using namespace std::chrono_literals;

TEST(MisdescribedDevice, MovesAsItTrulyDoesAndTellsWhatItWasTold) {
  for (const char* const name : {"wall-1dof", "omni"}) {
    SCOPED_TRACE(name);
    const auto description = device::load_device(name);
    const int dof = description.facts.degrees_of_freedom();
    const auto make = [&] { return device::SimulatedDevice(description, device::make_operator("wave", dof)); };
    device::SimulatedDevice truth = make();
    device::SimulatedDevice moved = make();
    control::DeviceFacts told = description.facts;
    told.damping *= 0.5;
    told.latency_s = 1e-4;
    MisdescribedDevice device(moved, told);
    EXPECT_EQ(device.facts().latency_s, 1e-4);
    for (device::Nanoseconds now = 0ms; now < 200ms; now += 1ms) {
      const device::Reading expected = truth.read(now);
      const device::Reading reading = device.read(now);
      ASSERT_EQ(reading.joint, expected.joint);
      ASSERT_TRUE(reading.damping->matrix().isApprox(0.5 * expected.damping->matrix(), 1e-6));
      const device::Vector force = device::Vector::Constant(dof, 0.1);
      truth.apply(now, force);
      device.apply(now, force);
    }
  }
}

}  // namespace
}  // namespace forcebound::sim
