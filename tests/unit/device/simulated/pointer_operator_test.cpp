#include "forcebound/device/simulated/pointer_operator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "forcebound/device/load_device.hpp"
#include "forcebound/device/simulated/make_operator.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"
#include "forcebound/time/heap_operations.hpp"

namespace forcebound::device {
namespace {

constexpr double kStep_s = 1e-3;

const PointerOperator& as_pointer(const Operator& hand) { return dynamic_cast<const PointerOperator&>(hand); }

TEST(PointerOperator, RestsAtItsOffsetAndHoldsLooselyUntilItIsPointed) {
  const auto hand = make_operator("pointer:offset_x_m=0.02,offset_z_m=-0.01", 3);
  for (int i = 0; i < 100; ++i) {
    const Operator::Target target = hand->target(i * kStep_s);
    EXPECT_EQ(target.position, Eigen::Vector3d(0.02, 0, -0.01));
    EXPECT_EQ(target.velocity.norm(), 0);
    EXPECT_LT(target.grip, 0.5);
  }
}

TEST(PointerOperator, FollowsThePointSmoothlyAndWithoutOvershoot) {
  const auto hand = make_operator("pointer:follow_s=0.02", 3);
  as_pointer(*hand).pointer()->point_to({0.01, 0, 0});
  Operator::Target before = hand->target(0);
  for (int i = 1; i < 400; ++i) {
    const Operator::Target target = hand->target(i * kStep_s);
    EXPECT_EQ(target.grip, 1);
    EXPECT_GE(target.position[0], before.position[0]);
    EXPECT_LE(target.position[0], 0.01);
    // Continuous in position and velocity: the chord's slope lies between the velocities at its ends, or near them.
    const double slope = (target.position[0] - before.position[0]) / kStep_s;
    EXPECT_NEAR(slope, 0.5 * (target.velocity[0] + before.velocity[0]), 0.01 / 0.02 * 0.002);
    before = target;
  }
  EXPECT_NEAR(before.position[0], 0.01, 1e-7);
}

TEST(PointerOperator, SolvesItsEquationForAPointAtRest) {
  const auto hand = make_operator("pointer:follow_s=0.02", 1);
  as_pointer(*hand).pointer()->point_to({0.01, 0, 0});
  (void)hand->target(0);
  Operator::Target target;
  for (int i = 1; i <= 30; ++i) target = hand->target(i * kStep_s);
  const double wt = 0.03 / 0.02;
  EXPECT_NEAR(target.position[0], 0.01 * (1 - (1 + wt) * std::exp(-wt)), 1e-12);
  EXPECT_NEAR(target.velocity[0], 0.01 / 0.02 * wt * std::exp(-wt), 1e-10);
}

TEST(PointerOperator, IsNeverFasterThanItsSpeedNorBeyondItsReach) {
  const auto hand = make_operator("pointer:speed_m_per_s=0.3,reach_m=0.1", 3);
  as_pointer(*hand).pointer()->point_to({9, -9, 0.05});
  Operator::Target target;
  for (int i = 0; i < 3000; ++i) {
    target = hand->target(i * kStep_s);
    EXPECT_LE(target.velocity.norm(), 0.3 + 1e-9);
  }
  EXPECT_LT((target.position - Eigen::Vector3d(0.1, -0.1, 0.05)).norm(), 1e-6);
}

TEST(PointerOperator, LoosensItsGripWhereItIsLetGo) {
  const auto hand = make_operator("pointer", 2);
  const auto& pointer = as_pointer(*hand).pointer();
  pointer->point_to({0.01, 0.02, 0});
  for (int i = 0; i < 500; ++i) (void)hand->target(i * kStep_s);
  pointer->let_go();
  const Operator::Target target = hand->target(0.6);
  EXPECT_NEAR(target.position[0], 0.01, 1e-6);
  EXPECT_NEAR(target.position[1], 0.02, 1e-6);
  EXPECT_LT(target.grip, 0.5);
}

TEST(PointerOperator, PassesOverAPointThatIsNotFinite) {
  const auto hand = make_operator("pointer", 3);
  const auto& pointer = as_pointer(*hand).pointer();
  pointer->point_to({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  EXPECT_FALSE(pointer->held());
  EXPECT_TRUE(hand->target(0.1).position.allFinite());
}

TEST(PointerOperator, PressesButtonsOfTheHandle) {
  const auto hand = make_operator("pointer", 3);
  const auto& pointer = as_pointer(*hand).pointer();
  EXPECT_EQ(hand->handle(0).buttons, 0U);
  pointer->press(3, true);
  pointer->press(40, true);
  pointer->press(-1, true);
  EXPECT_EQ(hand->handle(0).buttons, 8U);
  pointer->press(3, false);
  EXPECT_EQ(hand->handle(0).buttons, 0U);
}

TEST(PointerOperator, IsPushedBackVisiblyAndStaysStable) {
  for (const char* const name : {"wall-1dof", "cartesian-2dof", "cartesian-3dof", "firm-3dof", "omni"}) {
    SCOPED_TRACE(name);
    DeviceDescription description = load_device(name);
    const int dof = description.facts.degrees_of_freedom();
    SimulatedDevice device(std::move(description), make_operator("pointer:offset_x_m=0.02", dof));
    as_pointer(device.hand()).pointer()->point_to({0.02, 0, 0});
    Vector push = Vector::Zero(dof);
    push[0] = 2;
    Reading reading;
    for (int i = 0; i < 2000; ++i) {
      const Nanoseconds now = std::chrono::milliseconds(i);
      reading = device.read(now);
      device.apply(now, push);
    }
    // 2 N on 400 N/m, but for friction and an arm's geometry.
    EXPECT_NEAR(reading.position[0], 0.025, 2e-3);
    EXPECT_LT(device.truth().velocity.norm(), 1e-2);
  }
}

TEST(PointerOperator, TargetDoesNotAllocate) {
  if (!time::kCountsHeapOperations) GTEST_SKIP() << "the sanitizer's malloc does not count";
  const auto hand = make_operator("pointer", 3);
  as_pointer(*hand).pointer()->point_to({0.05, 0, 0});
  const std::uint64_t before = time::heap_operations_of_this_thread();
  for (int i = 0; i < 100; ++i) {
    (void)hand->target(i * kStep_s);
    (void)hand->handle(i * kStep_s);
  }
  EXPECT_EQ(time::heap_operations_of_this_thread(), before);
}

}  // namespace
}  // namespace forcebound::device
