// The tick's contract with the heap, for all of common/control in one place.

#include <gtest/gtest.h>

#include "tests/support/allocation_guard.hpp"
#include "tests/support/law_loop.hpp"
#include "tests/support/published_law_checks.hpp"
#include "tests/support/special_numbers.hpp"

namespace forcebound::control {
namespace {

using test::AllocationGuard;
using test::kNaN;
using test::LawLoop;

void expect_tick_without_heap(const char* law, int degrees_of_freedom, const LawParameters& parameters = {}) {
  SCOPED_TRACE(testing::Message() << law << ", " << degrees_of_freedom << " degrees of freedom");
  LawLoop loop(law, test::full_damping(degrees_of_freedom, 2),
               {.force_N_max = 10, .actuator_step_N = 0.01, .parameters = parameters});
  const Vector one = Vector::Ones(degrees_of_freedom);
  const AllocationGuard guard;
  for (int i = 0; i < 100; ++i) {
    loop.tick(1e-4 * i * one, (i % 2 == 0 ? 0.0 : 1.0) * one);
    loop.tick(1e-4 * i * one, 1e3 * one);
    loop.tick(1e-4 * i * one, kNaN * one);
    if (i % 10 == 0) loop.tick(kNaN * one, one);
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST(TransparentLaw, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const int degrees_of_freedom : {1, 3, 6}) expect_tick_without_heap("none", degrees_of_freedom);
}

TEST(LessConservativeLaw, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const int degrees_of_freedom : {1, 3, 6}) expect_tick_without_heap("fba-less", degrees_of_freedom);
}

TEST(MoreConservativeLaw, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const int degrees_of_freedom : {1, 3, 6}) expect_tick_without_heap("fba-more", degrees_of_freedom);
}

TEST(AdjustingOutputLimiter, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const int degrees_of_freedom : {1, 3, 6}) expect_tick_without_heap("aol", degrees_of_freedom);
}

TEST(EnergyBoundingLaw, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const int degrees_of_freedom : {1, 3, 6}) expect_tick_without_heap("eba", degrees_of_freedom);
}

TEST(TimeDomainPassivity, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const int degrees_of_freedom : {1, 3, 6}) {
    expect_tick_without_heap("tdpa", degrees_of_freedom);
    expect_tick_without_heap("tdpa", degrees_of_freedom, {{"variant", 2002}, {"weighting", 1}});
  }
}

TEST(PrioritisedDissipation, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const int degrees_of_freedom : {1, 3, 6}) {
    for (const double first : {0.0, 1.0})
      expect_tick_without_heap("tdpa-priority", degrees_of_freedom, {{"first", first}});
  }
}

TEST(InputToStateStability, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const int degrees_of_freedom : {1, 3}) {
    for (const double year : {2015.0, 2016.0}) expect_tick_without_heap("iss", degrees_of_freedom, {{"variant", year}});
  }
}

TEST(ExactLaw, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const int degrees_of_freedom : {1, 3, 6}) expect_tick_without_heap("fba-exact", degrees_of_freedom);
}

TEST(MemoryBasedPassivation, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const int degrees_of_freedom : {1, 3, 6}) expect_tick_without_heap("mbpa", degrees_of_freedom);
}

TEST(SuccessiveForceAugment, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const int degrees_of_freedom : {1, 3, 6}) expect_tick_without_heap("sfa", degrees_of_freedom);
}

TEST(VirtualCoupling, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const int degrees_of_freedom : {1, 3}) expect_tick_without_heap("vc", degrees_of_freedom);
}

TEST(ExactLaw, DoesNotAllocateWithAllThatARealDeviceHas) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  DeviceFacts facts;
  facts.damping = 5 * Matrix::Identity(3, 3);
  facts.friction = Vector::Constant(3, 0.1);
  facts.encoder_step = Vector::Constant(3, 55e-6);
  facts.actuator_step = Vector::Zero(3);
  facts.force_N_max = 3;
  ForceBounder bounder(facts, control::force_bounding_laws().make("fba-exact", facts));
  Motion motion;
  motion.jacobian = Matrix::Identity(3, 3);
  motion.position = Vector::Zero(3);
  const Vector request = Vector::Constant(3, 0.1);
  const AllocationGuard guard;
  for (int i = 0; i < 1000; ++i) {
    motion.interval_s = i % 7 == 0 ? 5e-3 : 1e-3;
    motion.latency_s = motion.latency_s_max = 1e-4 * (i % 20);
    motion.joint = motion.position.array() + 55e-6 * (i % 3);
    (void)bounder.confirmed(bounder.tick(motion, i % 5 * request), motion.latency_s_max);
  }
  EXPECT_EQ(guard.heap_operations(), 0U);
}

TEST(Damping, OfAnArmDoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const int degrees_of_freedom : {1, 3, 6}) {
    const Matrix jacobian = test::full_damping(degrees_of_freedom, 3);
    const Matrix joints = Matrix::Identity(degrees_of_freedom, degrees_of_freedom);
    const Vector v = Vector::Ones(degrees_of_freedom);
    double sum = 0;
    const AllocationGuard guard;
    const Damping damping = Damping::from_joints(jacobian, joints);
    sum += damping.dissipation(v) + damping.mobility(v);
    const std::uint64_t operations = guard.heap_operations();
    EXPECT_EQ(operations, 0U) << degrees_of_freedom;
    EXPECT_GT(sum, 0.0);
  }
}

TEST(ForceBounder, DoesNotAllocateForAnArm) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  for (const int degrees_of_freedom : {1, 3, 6}) {
    DeviceFacts facts;
    facts.cartesian = false;
    facts.damping = Matrix::Identity(degrees_of_freedom, degrees_of_freedom);
    facts.actuator_step = Vector::Constant(degrees_of_freedom, 1e-3);
    facts.force_N_max = 10;
    ForceBounder bounder(facts, published_laws().make("fba-more", facts));
    Motion motion;
    motion.interval_s = facts.period_s;
    motion.jacobian = test::full_damping(degrees_of_freedom, 4);
    const Damping damping = Damping::from_joints(motion.jacobian, facts.damping);
    motion.damping = &damping;
    const Vector one = Vector::Ones(degrees_of_freedom);
    double told = 0;
    const AllocationGuard guard;
    for (int i = 0; i < 100; ++i) {
      motion.position = motion.joint = 1e-3 * i * one;
      told += bounder.tick(motion, one).squaredNorm();
    }
    const std::uint64_t operations = guard.heap_operations();
    EXPECT_EQ(operations, 0U) << degrees_of_freedom;
    EXPECT_GT(told, 0.0);
  }
}

}  // namespace
}  // namespace forcebound::control
