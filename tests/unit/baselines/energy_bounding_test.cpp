// `eba`: a stiffness of b/T at most, and never returns more than a spring could have stored.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/ideal_device.hpp"
#include "tests/support/published_law_checks.hpp"

#include "forcebound/baselines/baselines.hpp"

namespace forcebound::baselines {
namespace {

using test::kB_N_per_m;
using test::kDamping_N_s_per_m;
using test::LawLoop;
using test::one_axis;
using test::to_matrix;
using test::to_vector;

constexpr const char* kEnergyBounding = "eba";

/// In to 1 mm, back to 0.2 mm and in again, at no steady speed.
double depth_m(int i) { return 6e-4 - 4e-4 * std::cos(i * 0.02) - 2e-4 * std::exp(-i * 0.01); }

TEST(EnergyBoundingLaw, ShowsAtMostDampingOverPeriodOfAStaticWall) {
  for (const double stiffness_N_per_m : {3e4, 5e4, 1.5e5, 1e9}) {
    SCOPED_TRACE(stiffness_N_per_m);
    LawLoop loop = one_axis(kEnergyBounding);
    loop.tick(0.0, 0.0);
    for (int i = 1; i <= 2000; ++i) {
      const double force_N = loop.tick(depth_m(i), -stiffness_N_per_m * depth_m(i));
      ASSERT_NEAR(force_N, -kB_N_per_m * depth_m(i), 1e-9 * kB_N_per_m * depth_m(i)) << i;
    }
  }
}

TEST(EnergyBoundingLaw, ShowsTheStiffnessThatC1Allows) {
  LawLoop loop = one_axis(kEnergyBounding, {{"c1_T_per_b", 0.5}});
  loop.tick(0.0, 0.0);
  for (int i = 1; i <= 400; ++i) {
    ASSERT_NEAR(loop.tick(depth_m(i), -1.0), -std::min(1.0, 0.5 * kB_N_per_m * depth_m(i)), 1e-9) << i;
    if (0.5 * kB_N_per_m * depth_m(i) > 1) break;
  }
}

TEST(EnergyBoundingLaw, ShowsASoftWallExactlyAndReleasesItAtLowerForces) {
  constexpr double kSoft_N_per_m = 1e4;
  LawLoop loop = one_axis(kEnergyBounding);
  loop.tick(0.0, 0.0);
  for (int i = 1; i <= 100; ++i) {
    ASSERT_NEAR(loop.tick(i * 1e-5, -kSoft_N_per_m * i * 1e-5), -kSoft_N_per_m * i * 1e-5, 1e-9) << i;
  }
  EXPECT_NEAR(loop.tick(98e-5, -9.8), -10 + kB_N_per_m * 2e-5, 1e-9) << "it falls with b/T, not with 10 N/mm";
}

TEST(EnergyBoundingLaw, LetsASpringOfC2ComeBackAsItWent) {
  constexpr double kSoft_N_per_m = 1e4;
  LawLoop loop = one_axis(kEnergyBounding, {{"c2_T_per_b", kSoft_N_per_m / kB_N_per_m}});
  loop.tick(0.0, 0.0);
  for (int i = 1; i <= 2000; ++i) {
    const double x_m = 1e-3 * (1.1 + std::sin(i * 0.005 - 1.5)) - 1e-4;
    const double force_N = loop.tick(x_m, -kSoft_N_per_m * x_m);
    ASSERT_NEAR(force_N, -kSoft_N_per_m * x_m, 0.05) << i;
  }
}

TEST(EnergyBoundingLaw, KeepsBothOfItsBoundsOnRandomRuns) {
  for (const double c2 : {0.3, 1.0, 4.0}) {
    SCOPED_TRACE(c2);
    const auto ticks = test::random_ticks({.seed = 3, .degrees_of_freedom = 1, .motion_m = 1e-4});
    LawLoop loop(kEnergyBounding, to_matrix({{kDamping_N_s_per_m}}), {.parameters = {{"c2_T_per_b", c2}}});
    double before_N = 0;
    double before_m = 0;
    int stopped = 0;
    for (const test::ReferenceTick& tick : ticks) {
      const double reaction_N = -loop.tick(tick.position_m[0], tick.request_N[0]);
      const double d = tick.position_m[0] - before_m;
      const double change_N = reaction_N - before_N;
      ASSERT_LE(change_N * d, kB_N_per_m * d * d * (1 + 1e-9) + 1e-18);
      // Where c1 leaves room for it, no more comes back than a spring c2 has stored.
      const double owed_J = (reaction_N * reaction_N - before_N * before_N) / (2 * c2 * kB_N_per_m) - reaction_N * d;
      const bool at_c1 = change_N * d >= kB_N_per_m * d * d * (1 - 1e-9);
      ASSERT_TRUE(owed_J <= 1e-12 || at_c1 || d == 0) << owed_J;
      stopped += std::abs(reaction_N + tick.request_N[0]) > 1e-9 ? 1 : 0;
      before_N = reaction_N;
      before_m = tick.position_m[0];
    }
    EXPECT_GT(stopped, 0) << "the law never bounded the force";
  }
}

TEST(EnergyBoundingLaw, HoldsWhileTheDeviceStandsStill) {
  LawLoop loop = one_axis(kEnergyBounding);
  loop.tick(0.0, 0.0);
  EXPECT_EQ(loop.tick(1e-4, -1.0), -1.0);
  EXPECT_EQ(loop.tick(1e-4, -2.0), -1.0);
  EXPECT_EQ(loop.tick(1e-4, 0.0), -1.0) << "a request that ends at a standstill ends nothing, as published";
  EXPECT_NEAR(loop.tick(0.5e-4, 0.0), 0.0, 1e-12);
}

TEST(EnergyBoundingLaw, NeverActsBesideTheRequest) {
  for (const int degrees_of_freedom : {3, 6}) {
    const auto ticks = test::random_ticks({.seed = 11, .degrees_of_freedom = degrees_of_freedom, .ticks = 2000});
    LawLoop loop(kEnergyBounding, to_matrix(ticks.front().damping_N_s_per_m), {.force_N_max = 15});
    double felt_N = 0;
    for (const test::ReferenceTick& tick : ticks) {
      const Vector request = to_vector(tick.request_N);
      const Vector force = loop.tick(to_vector(tick.position_m), request);
      ASSERT_LE(force.norm(), 15 * (1 + 1e-12));
      if (request.isZero(0)) continue;
      ASSERT_LE((force - force.dot(request) / request.squaredNorm() * request).norm(), 1e-12 * (1 + force.norm()));
      felt_N = std::max(felt_N, force.norm());
    }
    EXPECT_GT(felt_N, 1.0);
  }
}

TEST(EnergyBoundingLaw, IsPassiveAgainstAnyAdversary) {
  for (const double c1 : {0.3, 1.0}) {
    for (const double c2 : {0.1, 1.0, 4.0, 1e3}) {
      SCOPED_TRACE(testing::Message() << "c1 " << c1 << ", c2 " << c2);
      test::expect_passive_against_any_adversary(kEnergyBounding,
                                                 {.parameters = {{"c1_T_per_b", c1}, {"c2_T_per_b", c2}}});
    }
  }
  test::expect_passive_against_any_adversary(kEnergyBounding, {.force_N_max = 5, .actuator_step_N = 0.01});
}

TEST(EnergyBoundingLaw, StaysFiniteForHardRequests) { test::expect_finite_for_hard_requests(kEnergyBounding); }

TEST(EnergyBoundingLaw, EndsTheForceAfterAnIntervalWithoutReadings) {
  for (const double interval_s : {0.0, -1e-3, 1e308, std::nan("")}) {
    SCOPED_TRACE(interval_s);
    LawLoop loop = one_axis(kEnergyBounding);
    loop.tick(0.0, 0.0);
    EXPECT_EQ(loop.tick(1e-4, -1.0), -1.0);
    loop.set_interval(interval_s);
    EXPECT_EQ(loop.tick(2e-4, -1.0), 0.0);
  }
  LawLoop loop = one_axis(kEnergyBounding);
  loop.tick(0.0, 0.0);
  EXPECT_EQ(loop.tick(1e-4, -1.0), -1.0);
  EXPECT_EQ(loop.tick(std::nan(""), -1.0), 0.0);
  EXPECT_EQ(loop.tick(3e-4, -1.0), 0.0) << "the displacement is unknown";
  EXPECT_EQ(loop.tick(4e-4, -1.0), -1.0);
}

std::string refusal_of_bounds(const control::LawParameters& parameters) {
  return shipped_laws().refusal(kEnergyBounding, test::ideal_device(1), {.parameters = parameters});
}

TEST(EnergyBoundingLaw, RefusesInvalidBounds) {
  EXPECT_EQ(refusal_of_bounds({{"c1_T_per_b", 1.1}}), "law 'eba': c1_T_per_b must be 0.001 to 1, got 1.1");
  EXPECT_EQ(refusal_of_bounds({{"c2_T_per_b", 0}}), "law 'eba': c2_T_per_b must be 0.001 to 1000, got 0");
  EXPECT_EQ(refusal_of_bounds({{"c3", 1}}), "law 'eba' has no parameter 'c3' (known: c1_T_per_b, c2_T_per_b)");
  EXPECT_EQ(refusal_of_bounds({{"c1_T_per_b", 1}, {"c2_T_per_b", 1e3}}), "");
}

}  // namespace
}  // namespace forcebound::baselines
