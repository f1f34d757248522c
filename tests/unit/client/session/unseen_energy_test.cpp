#include "forcebound/client/session/unseen_energy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "forcebound/client/session/hand_safety.hpp"
#include "forcebound/control/force_bounder.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/command_times.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "tests/support/allocation_guard.hpp"

namespace forcebound::client {
namespace {

using namespace std::chrono_literals;
using time::Nanoseconds;

constexpr const char* kDevices[] = {"wall-1dof", "cartesian-2dof", "cartesian-3dof", "firm-3dof", "omni",
                                    "falcon",    "omega-3",        "haply-2diy",     "arm-6dof"};
constexpr double kStiffness_N_per_m = 2000;

/// What a hand does along its last axis: it goes 30 mm into a floor within a second, stays, and leaves.
struct Hands {
  double stiffness_N_per_m = 500;
  double leaves_s = 2;
  double leaves_m_per_s = 0.1;
};

class Pressing final : public device::Operator {
 public:
  Pressing(int axes, const Hands& hands) : axes_(axes), hands_(hands) {
    hand_ = {.mass_kg = 0.2,
             .stiffness_N_per_m = hands.stiffness_N_per_m,
             .damping_N_s_per_m = 5,
             .inertia_kg_m2 = 1e-4,
             .rotation_stiffness_N_m_per_rad = 1,
             .rotation_damping_N_m_s_per_rad = 0.01};
  }
  [[nodiscard]] std::string_view name() const noexcept override { return "pressing"; }
  [[nodiscard]] std::string description() const override { return "presses, stays and leaves"; }
  [[nodiscard]] int degrees_of_freedom() const noexcept override { return axes_; }
  [[nodiscard]] const device::Hand& hand() const noexcept override { return hand_; }
  [[nodiscard]] Target target(double time_s) const noexcept override {
    Target target{.position = Vector::Zero(axes_), .velocity = Vector::Zero(axes_)};
    double& place_m = target.position[axes_ - 1];
    double& speed_m_per_s = target.velocity[axes_ - 1];
    place_m = 0.01 - 0.04 * std::min(time_s, 1.0);
    if (time_s < 1) speed_m_per_s = -0.04;
    if (time_s < hands_.leaves_s) return target;
    const double left_m = hands_.leaves_m_per_s * (time_s - hands_.leaves_s);
    place_m += std::min(left_m, 0.1);
    speed_m_per_s = left_m < 0.1 ? hands_.leaves_m_per_s : 0;
    return target;
  }

 private:
  int axes_;
  Hands hands_;
  device::Hand hand_;
};

/// A device on a stiff floor, with the law and a person's limits, whose readings freeze while it is read and answers.
class Felt {
 public:
  Felt(const std::string& name, const Hands& hands, const device::Safety& limits)
      : Felt(device::load_device(name), hands, limits) {}

  void run(Nanoseconds until) {
    for (; now_ < until; now_ += 1ms) tick();
  }

  [[nodiscard]] double least_P_J() const { return device.audit()->minimum_J; }
  [[nodiscard]] std::uint64_t reports() const { return safety.trips(HandSafety::Trip::frozen); }
  [[nodiscard]] double force_N() const { return applied_.norm(); }

  device::SimulatedDevice device;
  Nanoseconds frozen_from{Nanoseconds::max()};
  Nanoseconds frozen_until{Nanoseconds::max()};
  int frozen_joint = -1;  ///< of a Cartesian device, it alone
  HandSafety safety;

 private:
  Felt(const device::DeviceDescription& description, const Hands& hands, const device::Safety& limits)
      : device(description, std::make_unique<Pressing>(description.facts.translations(), hands)),
        safety(limits, description.facts.force_N_max),
        unseen_(description.facts, limits),
        bounder_(description.facts, control::force_bounding_laws().make("fba-exact", description.facts)),
        times_(device),
        applied_(Vector::Zero(description.facts.degrees_of_freedom())) {}

  [[nodiscard]] device::Reading read() {
    device::Reading reading = device.read(now_);
    if (now_ < frozen_from || now_ >= frozen_until) return shown_ = reading;
    if (frozen_joint >= 0) {
      reading.joint[frozen_joint] = reading.position[frozen_joint] = shown_.joint[frozen_joint];
      return shown_ = reading;
    }
    shown_.latched = now_;
    return shown_;
  }

  void tick() {
    const device::Reading reading = read();
    const Eigen::Index axis = device.facts().translations() - 1;
    unseen_.add(reading, applied_, 1e-3);
    Vector floor_N = Vector::Zero(axis + 1);
    floor_N[axis] = std::min(device.facts().force_N_max, kStiffness_N_per_m * std::max(0.0, -reading.position[axis]));
    const Vector before_N = applied_.head(axis + 1);
    Vector request = Vector::Zero(applied_.rows());
    request.head(axis + 1) = safety.limited(floor_N, {.position = reading.position,
                                                      .applied_N = before_N,
                                                      .elapsed_s = 1e-3,
                                                      .believed = unseen_.share(),
                                                      .frozen = unseen_.frozen()});
    times_.begin_choosing(now_);
    const Vector chosen = bounder_.tick(times_.motion_at(reading), request);
    applied_ = bounder_.confirmed(chosen, times_.command_at(reading, now_));
    device.apply(now_, applied_);
  }

  UnseenEnergy unseen_;
  control::ForceBounder bounder_;
  device::CommandTimes times_;
  Vector applied_;
  device::Reading shown_{};
  Nanoseconds now_{0};
};

device::Safety of_a_person() { return {.ramp_s = 0.5}; }

TEST(UnseenEnergy, AHandGetsAtMost50MillijoulesFromADeviceThatFreezes) {
  constexpr double kLeakOfNobody_J = -0.9;
  double unbounded_J = 0;
  for (const char* const name : kDevices) {
    for (const double leaves_m_per_s : {0.05, 0.3}) {
      for (const int frozen_ms : {700, 1500, 1800, 1950, 1990, 2000, 2020, 2050, 2100}) {
        SCOPED_TRACE(std::string(name) + ", frozen after " + std::to_string(frozen_ms) + " ms, leaves with " +
                     std::to_string(leaves_m_per_s) + " m/s");
        Felt felt(name, {.leaves_m_per_s = leaves_m_per_s}, of_a_person());
        felt.frozen_from = frozen_ms * 1ms;
        felt.run(4s);
        EXPECT_GE(felt.least_P_J(), -UnseenEnergy::kMost_J);
        if (unbounded_J < kLeakOfNobody_J) continue;
        Felt unbounded(name, {.leaves_m_per_s = leaves_m_per_s}, {});
        unbounded.frozen_from = frozen_ms * 1ms;
        unbounded.run(4s);
        unbounded_J = std::min(unbounded_J, unbounded.least_P_J());
      }
    }
  }
  EXPECT_LT(unbounded_J, kLeakOfNobody_J) << "where nobody is believed to feel it";
}

TEST(UnseenEnergy, OneAxisThatFreezesIsEnough) {
  Felt felt("firm-3dof", {}, of_a_person());
  felt.frozen_joint = 2;
  felt.frozen_from = 1900ms;
  felt.run(4s);
  EXPECT_GE(felt.least_P_J(), -UnseenEnergy::kMost_J);
  EXPECT_EQ(felt.reports(), 1U);
}

TEST(UnseenEnergy, IsSaidOnceWithin200MillisecondsAndTheForceComesBackByARamp) {
  Felt felt("firm-3dof", {.leaves_s = 9}, of_a_person());
  felt.frozen_from = 1500ms;
  felt.frozen_until = 2500ms;
  felt.run(1710ms);
  EXPECT_EQ(felt.reports(), 1U);
  EXPECT_EQ(felt.force_N(), 0);
  felt.run(2600ms);
  EXPECT_LT(felt.force_N(), 7);
  felt.run(4s);
  EXPECT_GT(felt.force_N(), 8) << "as the floor's";
  EXPECT_EQ(felt.reports(), 1U);
}

TEST(UnseenEnergy, AHandThatRestsIsNeverSaidToBeFrozenAndKeepsItsForce) {
  for (const char* const name : kDevices) {
    for (const double stiffness_N_per_m : {100.0, 500.0, 2000.0, 4000.0}) {
      SCOPED_TRACE(std::string(name) + ", a hand of " + std::to_string(stiffness_N_per_m) + " N/m");
      const Hands hands{.stiffness_N_per_m = stiffness_N_per_m, .leaves_s = 9};
      Felt felt(name, hands, of_a_person());
      Felt free(name, hands, {});
      double felt_Ns = 0;
      double free_Ns = 0;
      for (Nanoseconds until = 2s; until < 5s; until += 1ms) {
        felt.run(until);
        free.run(until);
        felt_Ns += 1e-3 * felt.force_N();
        free_Ns += 1e-3 * free.force_N();
      }
      EXPECT_EQ(felt.reports(), 0U);
      EXPECT_GT(felt_Ns, 0.85 * free_Ns);
    }
  }
}

TEST(UnseenEnergy, AnAxisThatFrictionHoldsIsNotSaidToBeFrozen) {
  const auto device = device::load_device("wall-1dof");
  for (const double force_N : {0.5, 2.0, 7.0}) {
    UnseenEnergy unseen(device.facts, of_a_person());
    const device::Reading stuck{
        .joint = Vector::Zero(1), .position = Vector::Zero(1), .jacobian = control::Matrix::Identity(1, 1)};
    for (int tick = 0; tick < 5000; ++tick) unseen.add(stuck, Vector::Constant(1, unseen.share() * force_N), 1e-3);
    EXPECT_FALSE(unseen.frozen()) << force_N;
  }
}

TEST(UnseenEnergy, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  const auto device = device::load_device("omni");
  UnseenEnergy unseen(device.facts, of_a_person());
  device::Reading reading{
      .joint = Vector::Zero(3), .position = Vector::Zero(3), .jacobian = control::Matrix::Identity(3, 3)};
  const Vector applied = Vector::Constant(3, 2);
  const test::AllocationGuard guard;
  for (int tick = 0; tick < 300; ++tick) {
    if (tick < 20) reading.joint[0] += 1e-3;
    unseen.add(reading, applied, 1e-3);
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
  EXPECT_TRUE(unseen.frozen());
}

}  // namespace
}  // namespace forcebound::client
