#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/pressed_wall.hpp"
#include "tests/support/published_law_checks.hpp"

namespace forcebound::baselines {
namespace {

using test::LawLoop;
using test::one_axis;

/// A wall at x >= 0, to `depth_m` and back in steps of `step_m`; what it took less what it gave [J].
double press_and_release(LawLoop& loop, double depth_m, double step_m, double stiffness_N_per_m) {
  double kept_J = 0;
  double at_m = 0;
  double force_N = loop.tick(at_m, 0.0);
  const auto move = [&](double next_m) {
    kept_J -= force_N * (next_m - at_m);
    at_m = next_m;
    force_N = loop.tick(at_m, -stiffness_N_per_m * std::max(0.0, at_m));
  };
  const int steps = static_cast<int>(std::lround(depth_m / step_m));
  for (int i = 1; i <= steps; ++i) move(i * step_m);
  for (int i = steps - 1; i >= -2; --i) move(i * step_m);
  EXPECT_EQ(force_N, 0.0);
  return kept_J;
}

TEST(MemoryBasedPassivation, GivesWhatIsAskedForWhilePressing) {
  LawLoop loop = one_axis("mbpa");
  loop.tick(0.0, 0.0);
  for (int i = 1; i <= 2000; ++i) {
    const double request_N = -1 - 1e3 * std::abs(std::sin(i * 0.1));
    ASSERT_EQ(loop.tick(i * 1e-6, request_N), request_N) << i;
  }
}

TEST(MemoryBasedPassivation, ReturnsNoMoreThanPressingStoredButForTheStepOfTheTurn) {
  for (const double stiffness_N_per_m : {1e3, 150e3, 1e7}) {
    for (const double step_m : {1e-6, 2e-5, 1e-4}) {
      LawLoop loop = one_axis("mbpa");
      for (int cycle = 0; cycle < 3; ++cycle) {
        const double kept_J = press_and_release(loop, 1e-3, step_m, stiffness_N_per_m);
        const double turn_J = stiffness_N_per_m * step_m * step_m;  // of the one step that reverses
        EXPECT_GE(kept_J, -turn_J * (1 + 1e-6)) << stiffness_N_per_m << " N/m in steps of " << step_m << " m";
      }
    }
  }
}

TEST(MemoryBasedPassivation, ReleasesAlongThePathOfPressing) {
  constexpr double kStiffness_N_per_m = 1e4;
  constexpr double kStep_m = 1e-5;
  LawLoop loop = one_axis("mbpa");
  loop.tick(0.0, 0.0);
  for (int i = 1; i <= 100; ++i) loop.tick(i * kStep_m, -kStiffness_N_per_m * i * kStep_m);
  for (int i = 99; i >= 1; --i) {
    // Held from here to the next reading, it may be what was held there on the way in: that of the depth before.
    const double force_N = loop.tick(i * kStep_m, -kStiffness_N_per_m * i * kStep_m);
    ASSERT_NEAR(force_N, -kStiffness_N_per_m * (i - 1) * kStep_m, 1e-9) << i;
  }
}

TEST(MemoryBasedPassivation, GoesOnAtRestAsBefore) {
  constexpr double kStiffness_N_per_m = 1e4;
  constexpr double kStep_m = 1e-5;
  LawLoop loop = one_axis("mbpa");
  loop.tick(0.0, 0.0);
  const auto wall = [&](int steps) { return loop.tick(steps * kStep_m, -kStiffness_N_per_m * steps * kStep_m); };
  for (int i = 1; i <= 50; ++i) {
    for (int tick = 0; tick < 3; ++tick) ASSERT_EQ(wall(i), -kStiffness_N_per_m * i * kStep_m) << i << " steps in";
  }
  for (int i = 49; i >= 1; --i) {
    for (int tick = 0; tick < 3; ++tick) ASSERT_NEAR(wall(i), -kStiffness_N_per_m * (i - 1) * kStep_m, 1e-9) << i;
  }
}

TEST(MemoryBasedPassivation, ReturnsNoEnergyThatPressingDidNotStore) {
  LawLoop loop = one_axis("mbpa");
  loop.tick(0.0, 0.0);
  for (int i = 1; i <= 100; ++i) EXPECT_EQ(loop.tick(i * 1e-5, 5.0), 0.0) << "pushed along, from the beginning";
}

TEST(MemoryBasedPassivation, StaysWithinOneStepOfWhatItStoredOnRandomMotion) {
  // Only what the force took and gave; the device's damping is not counted.
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    LawLoop loop = one_axis("mbpa");
    double at_m = 0;
    double step_m = 0;
    double force_N = loop.tick(at_m, 0.0);
    double kept_J = 0;
    constexpr double kForceMost_N = 20;
    double step_most_m = 0;
    for (int i = 0; i < 20000; ++i) {
      step_m = 0.9 * step_m + 1e-5 * normal(random);
      step_most_m = std::max(step_most_m, std::abs(step_m));
      kept_J -= force_N * step_m;
      at_m += step_m;
      ASSERT_GE(kept_J, -kForceMost_N * step_most_m) << "tick " << i;
      force_N = loop.tick(at_m, std::clamp(8 * normal(random), -kForceMost_N, kForceMost_N));
    }
  }
}

TEST(MemoryBasedPassivation, ForgetsOnlyEnergyWhereThePathIsLongerThanItsMemory) {
  LawLoop loop = one_axis("mbpa");
  EXPECT_GE(press_and_release(loop, 5e-2, 1e-6, 1e3), 0.0);
  double force_N = 0;
  loop.tick(0.0, 0.0);
  for (int i = 1; i <= 20000; ++i) force_N = loop.tick(i * 1e-6, -1e3 * i * 1e-6);
  const double stored_J = 1e3 * 0.02 * 0.02 / 2;
  EXPECT_EQ(force_N, -20.0);
  EXPECT_LT(loop.energy_J(), stored_J);
  EXPECT_GT(loop.energy_J(), 0.98 * stored_J);
}

TEST(MemoryBasedPassivation, FollowsAForceThatTurnsButNotOneThatTurnsBack) {
  LawLoop loop("mbpa", 30 * Matrix::Identity(2, 2));
  const auto at = [](double x, double y) { return Vector{{x, y}}; };
  loop.tick(at(0, 0), at(0, 0));
  loop.tick(at(1e-4, 0), at(-10, 0));
  loop.tick(at(2e-4, 0), at(-10, 0));
  EXPECT_GT(loop.tick(at(1.9e-4, 0), at(-8, 6)).norm(), 9.0) << "37 degrees";
  EXPECT_TRUE(loop.tick(at(2.0e-4, 0), at(8, -6)).isZero(0)) << "the other way there is no path";
}

TEST(MemoryBasedPassivation, ShowsAWallThatIsAskedFor) {
  for (const double hand_N_per_m : {200.0, 500.0, 1000.0}) {
    const auto result =
        test::press({.law = "mbpa", .stiffness_N_per_m = 40e3, .hand_N_per_m = hand_N_per_m, .retreats = true});
    EXPECT_NEAR(result.shown_N_per_m, 40e3, 0.01 * 40e3) << hand_N_per_m;
    EXPECT_LT(result.ripple_N, 0.1) << hand_N_per_m;
    EXPECT_GE(result.least_P_J, -1e-6) << hand_N_per_m;
  }
}

TEST(MemoryBasedPassivation, ReturnsLessOfAStiffWallThanIfNothingWereBounded) {
  const auto bounded = test::press({.law = "mbpa"});
  const auto unbounded = test::press({.law = "none"});
  EXPECT_LT(bounded.returned_J - bounded.stored_J, 0.5 * (unbounded.returned_J - unbounded.stored_J));
}

TEST(MemoryBasedPassivation, HasNoPathAfterALostReading) {
  LawLoop loop = one_axis("mbpa");
  for (int i = 0; i <= 10; ++i) loop.tick(i * 1e-4, -5.0);
  EXPECT_EQ(loop.tick(std::nan(""), -5.0), 0.0);
  EXPECT_EQ(loop.tick(9e-4, -5.0), 0.0);
  EXPECT_EQ(loop.tick(8e-4, -5.0), 0.0);
  EXPECT_EQ(loop.energy_J(), 0.0);
}

TEST(MemoryBasedPassivation, HasNoPathAfterAnIntervalThatNoClockMeasured) {
  for (const double interval_s : {0.0, -1e-3, 1e308, std::nan("")}) {
    LawLoop loop = one_axis("mbpa");
    for (int i = 0; i <= 10; ++i) loop.tick(i * 1e-4, -5.0);
    loop.set_interval(interval_s);
    EXPECT_EQ(loop.tick(9e-4, -5.0), 0.0) << interval_s;
    EXPECT_EQ(loop.energy_J(), 0.0);
  }
}

TEST(MemoryBasedPassivation, StaysFiniteForHardRequests) { test::expect_finite_for_hard_requests("mbpa"); }

}  // namespace
}  // namespace forcebound::baselines
