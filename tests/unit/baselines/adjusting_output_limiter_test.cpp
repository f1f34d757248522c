// `aol`: one degree of freedom is fba-less, several bend the direction.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/published_law_checks.hpp"

#include "forcebound/baselines/baselines.hpp"

namespace forcebound::baselines {
namespace {

using test::LawLoop;
using test::to_matrix;
using test::to_vector;

constexpr const char* kAdjustingOutputLimiter = "aol";

TEST(AdjustingOutputLimiter, IsTheLessConservativeLawInOneDegreeOfFreedom) {
  for (const bool damping_changes : {false, true}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << (damping_changes ? ", damping changes" : ""));
      const auto ticks = test::random_ticks(
          {.seed = seed, .degrees_of_freedom = 1, .damping_changes = damping_changes, .motion_m = 1e-4});
      const Matrix damping = to_matrix(ticks.front().damping_N_s_per_m);
      LawLoop aol(kAdjustingOutputLimiter, damping, {.force_N_max = 15});
      LawLoop less("fba-less", damping, {.force_N_max = 15});
      int bounded = 0;
      for (const test::ReferenceTick& tick : ticks) {
        aol.set_damping(to_matrix(tick.damping_N_s_per_m));
        less.set_damping(to_matrix(tick.damping_N_s_per_m));
        const double expected_N = less.tick(tick.position_m[0], tick.request_N[0]);
        ASSERT_NEAR(aol.tick(tick.position_m[0], tick.request_N[0]), expected_N, 1e-12 * std::abs(expected_N));
        ASSERT_NEAR(aol.energy_J(), less.energy_J(), 1e-12 * std::abs(less.energy_J()));
        bounded += std::abs(expected_N) < std::min(15.0, std::abs(tick.request_N[0])) ? 1 : 0;
      }
      EXPECT_GT(bounded, 0) << "the law never bounded the force";
    }
  }
}

TEST(AdjustingOutputLimiter, BendsTheDirectionInThree) {
  // Only x has moved, so only x has anything to spend.
  LawLoop loop(kAdjustingOutputLimiter, 30 * Matrix::Identity(3, 3));
  loop.tick(to_vector({0, 0, 0}), to_vector({0, 0, 0}));
  const Vector force = loop.tick(to_vector({1e-4, 0, 1e-5}), to_vector({-10, -10, -10}));
  const double stiffness_N_per_m = 2 * 30 / 1e-3;  // |f| = 2 sqrt(B B d^2)
  EXPECT_NEAR(force[0], -stiffness_N_per_m * 1e-4, 1e-12);
  EXPECT_EQ(force[1], 0.0);
  EXPECT_NEAR(force[2], -stiffness_N_per_m * 1e-5, 1e-12);
}

TEST(AdjustingOutputLimiter, BoundsEachAxisAsIfItWereAlone) {
  const auto ticks = test::random_ticks({.seed = 4, .degrees_of_freedom = 3, .motion_m = 1e-4});
  const Matrix damping = to_matrix({{4, 0, 0}, {0, 15, 0}, {0, 0, 30}});
  LawLoop together(kAdjustingOutputLimiter, damping);
  std::vector<LawLoop> alone;
  for (Eigen::Index i = 0; i < 3; ++i) alone.emplace_back("fba-less", damping.block(i, i, 1, 1));
  for (const test::ReferenceTick& tick : ticks) {
    const Vector force = together.tick(to_vector(tick.position_m), to_vector(tick.request_N));
    for (std::size_t i = 0; i < 3; ++i) {
      const double expected_N = alone[i].tick(tick.position_m[i], tick.request_N[i]);
      ASSERT_NEAR(force[static_cast<Eigen::Index>(i)], expected_N, 1e-12 * std::abs(expected_N));
    }
  }
}

TEST(AdjustingOutputLimiter, CreditsCoupledAxesNoMoreThanTheDeviceDissipates) {
  // Eigenvalues 10 and 30 along the diagonals: of a motion along the first, all is credited.
  LawLoop loop(kAdjustingOutputLimiter, to_matrix({{20, 10}, {10, 20}}));
  loop.tick(to_vector({0, 0}), to_vector({0, 0}));
  loop.tick(to_vector({1e-3, -1e-3}), to_vector({0, 0}));
  EXPECT_NEAR(loop.energy_J(), 10 * 2e-6 / 1e-3, 1e-12);
  loop.tick(to_vector({2e-3, 0}), to_vector({0, 0}));
  EXPECT_NEAR(loop.energy_J(), 2 * 10 * 2e-6 / 1e-3, 1e-12) << "a third of what the damping takes";
}

TEST(AdjustingOutputLimiter, IsPassiveAgainstAnyAdversary) {
  test::expect_passive_against_any_adversary(kAdjustingOutputLimiter);
  test::expect_passive_against_any_adversary(kAdjustingOutputLimiter, {.force_N_max = 5, .actuator_step_N = 0.01});
}

TEST(AdjustingOutputLimiter, StaysFiniteForHardRequests) {
  test::expect_finite_for_hard_requests(kAdjustingOutputLimiter);
}

TEST(AdjustingOutputLimiter, ChargesTheWorstCaseForUnusableReadings) {
  LawLoop aol(kAdjustingOutputLimiter, to_matrix({{30}}));
  LawLoop less("fba-less", to_matrix({{30}}));
  for (int i = 0; i < 400; ++i) {
    const double interval_s = i % 17 == 0 ? -1.0 : i % 11 == 0 ? 4e-3 : 1e-3;
    aol.set_interval(interval_s);
    less.set_interval(interval_s);
    const double position_m = i % 23 == 0 ? std::nan("") : 1e-3 * std::sin(0.1 * i);
    ASSERT_EQ(aol.tick(position_m, -30.0), less.tick(position_m, -30.0)) << i;
    ASSERT_EQ(aol.energy_J(), less.energy_J()) << i;
  }
}

TEST(AdjustingOutputLimiter, RefusesWhatItCannotWorkWith) {
  const control::LawRegistry laws = shipped_laws();
  control::DeviceFacts facts;
  facts.damping = Matrix::Identity(3, 3);
  EXPECT_THROW((void)laws.make(kAdjustingOutputLimiter, facts, {.parameters = {{"c1_T_per_b", 1}}}),
               std::invalid_argument);
  facts.period_s = 0;
  EXPECT_THROW((void)laws.make(kAdjustingOutputLimiter, facts), std::invalid_argument);
  EXPECT_THROW((void)laws.make(kAdjustingOutputLimiter, control::DeviceFacts{}), std::invalid_argument)
      << "no degree of freedom";
}

}  // namespace
}  // namespace forcebound::baselines
