#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>

#include "forcebound/control/exact_law.hpp"
#include "forcebound/control/force_bounder.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "tests/support/allocation_guard.hpp"

namespace forcebound::device {
namespace {

using std::chrono::milliseconds;

constexpr Nanoseconds kOrigin = std::chrono::hours(2);
constexpr int kTicks = 3000;
constexpr int kLateTicks = 20;
constexpr double kWall_N_per_m = 5000;

/// Joints one after another in front of a base 0.16 m away: yaw, shoulder, elbow, wrist, and a turn of the forearm.
DeviceDescription spatial_chain(int joints) {
  static const std::array<std::string, 5> kJoints{"axis = [0, 0, 1]\npoint_m = [0, 0.16, 0]\nstart_rad = 0.1\n",
                                                  "axis = [-1, 0, 0]\npoint_m = [0, 0.16, 0]\nstart_rad = 0.8\n",
                                                  "axis = [1, 0, 0]\npoint_m = [0, 0.03, 0]\nstart_rad = 1.6\n",
                                                  "axis = [1, 0, 0]\npoint_m = [0, -0.1, 0]\nstart_rad = 0.4\n",
                                                  "axis = [0, 1, 0]\npoint_m = [0, -0.1, 0.01]\n"};
  std::string text =
      "kind = 'chain'\ndegrees_of_freedom = 3\njoint_inertia_kg_m2 = 8e-4\njoint_damping_N_m_s_per_rad = 5e-3\n"
      "joint_friction_N_m = 1e-3\nencoder_step_rad = 4e-4\nforce_N_max = 5\n[chain]\ntip_m = [0, -0.15, 0]\n";
  for (int i = 0; i < joints; ++i) {
    text += "[[chain.joint]]\nname = 'joint " + std::to_string(i) + "'\n" + kJoints.at(static_cast<std::size_t>(i));
  }
  return parse_device(text, "chain-" + std::to_string(joints) + ".toml");
}

/// The kinds that do not ship, and those that do.
DeviceDescription device_of(const std::string& name) {
  if (name == "chain-3") return spatial_chain(3);
  return name == "chain-5" ? spatial_chain(5) : load_device(name);
}

struct Pressed {
  double least_J = 0;
  double final_J = 0;
  double force_N = 0;  // the largest that was shown
};

/// A hand that presses from free space into a wall at y >= 0, of which it feels what was 20 ms ago.
Pressed press(const DeviceDescription& description, std::unique_ptr<control::PassivityLaw> law) {
  const int dof = description.facts.degrees_of_freedom();
  SimulatedDevice device(description, make_operator("press:axis=1,from_m=-0.01,to_m=0.003", dof));
  control::ForceBounder bounder(description.facts, std::move(law));
  std::array<double, kLateTicks> depth_m{};
  Pressed pressed;
  for (int tick = 0; tick < kTicks; ++tick) {
    const Nanoseconds now = kOrigin + tick * milliseconds(1);
    const Reading reading = device.read(now);
    double& late = depth_m[static_cast<std::size_t>(tick % kLateTicks)];
    Vector request = Vector::Zero(dof);
    request[1] = -kWall_N_per_m * std::max(0.0, late);
    late = reading.position[1];
    const control::Motion motion{.interval_s = tick == 0 ? 0.0 : 1e-3,
                                 .position = reading.position,
                                 .joint = reading.joint,
                                 .jacobian = reading.jacobian,
                                 .damping = reading.damping};
    const Vector force = bounder.confirmed(bounder.tick(motion, request), 0);
    device.apply(now, force);
    pressed.force_N = std::max(pressed.force_N, force.norm());
  }
  (void)device.read(kOrigin + kTicks * milliseconds(1));
  pressed.least_J = device.audit()->minimum_J;
  pressed.final_J = device.audit()->energy_J;
  return pressed;
}

class KindsOfDevice : public testing::TestWithParam<const char*> {};

TEST_P(KindsOfDevice, ArePassiveAtALateWallWithTheExactLawAndNotWithoutALaw) {
  const DeviceDescription description = device_of(GetParam());
  const Pressed bounded = press(description, std::make_unique<control::ExactLaw>(description.facts));
  EXPECT_GE(bounded.least_J, -1e-9);
  EXPECT_GT(bounded.force_N, 0.05) << "or nothing was shown";
  const Pressed free = press(description, control::published_laws().make("none", description.facts));
  EXPECT_LT(free.least_J, -1e-3) << "or the wall is none that needs a law";
}

TEST_P(KindsOfDevice, ReadAndApplyWithoutAllocating) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const DeviceDescription description = device_of(GetParam());
  const int dof = description.facts.degrees_of_freedom();
  SimulatedDevice device(description, make_operator("wave", dof));
  control::ForceBounder bounder(description.facts, std::make_unique<control::ExactLaw>(description.facts));
  const Vector pull = Vector::Constant(dof, 0.5);
  const test::AllocationGuard guard;
  for (int tick = 0; tick < 500; ++tick) {
    const Nanoseconds now = kOrigin + tick * milliseconds(1);
    const Reading reading = device.read(now);
    const control::Motion motion{.interval_s = tick == 0 ? 0.0 : 1e-3,
                                 .position = reading.position,
                                 .joint = reading.joint,
                                 .jacobian = reading.jacobian,
                                 .damping = reading.damping};
    device.apply(now, bounder.tick(motion, pull));
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST_P(KindsOfDevice, StayFiniteWhereAHandPullsThemOutOfReach) {
  const DeviceDescription description = device_of(GetParam());
  const int dof = description.facts.degrees_of_freedom();
  for (const char* const spec : {"press:axis=1,from_m=0,to_m=0.6,approach_s=0.3",
                                 "press:axis=1,from_m=0,to_m=-0.6,approach_s=0.3,stiffness_N_per_m=2000",
                                 "wave:amplitude_m=0.4,frequency_Hz=1.5"}) {
    SCOPED_TRACE(spec);
    SimulatedDevice device(description, make_operator(spec, dof));
    for (int tick = 0; tick < 4000; ++tick) {
      const Nanoseconds now = kOrigin + tick * milliseconds(1);
      const Reading reading = device.read(now);
      ASSERT_TRUE(is_usable(reading, dof, description.facts.joints())) << tick;
      ASSERT_TRUE(reading.damping->matrix().allFinite()) << tick;
      device.apply(now, Vector::Constant(dof, tick % 2 ? 1 : -1));
    }
    ASSERT_TRUE(std::isfinite(device.audit()->energy_J));
  }
}

INSTANTIATE_TEST_SUITE_P(Simulated, KindsOfDevice,
                         testing::Values("omni", "falcon", "omega-3", "haply-2diy", "chain-3", "chain-5"),
                         [](const auto& name) {
                           std::string word = name.param;
                           std::erase(word, '-');
                           return word;
                         });

}  // namespace
}  // namespace forcebound::device
