#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/ideal_device.hpp"
#include "tests/support/pressed_wall.hpp"
#include "tests/support/published_law_checks.hpp"

namespace forcebound::baselines {
namespace {

using test::kB_N_per_m;
using test::LawLoop;
using test::one_axis;

constexpr double kWall_N_per_m = 150e3;
constexpr double kIncrement_N = kB_N_per_m * 2e-7;

double wall_N(double depth_m) { return -kWall_N_per_m * std::max(0.0, depth_m); }

TEST(SuccessiveForceAugment, BeginsWithASpringOfDampingOverPeriod) {
  LawLoop loop = one_axis("sfa");
  loop.tick(0.0, 0.0);
  EXPECT_NEAR(loop.tick(1e-4, wall_N(1e-4)), -kB_N_per_m * 1e-4, 1e-9);
}

TEST(SuccessiveForceAugment, GrowsByTheIncrementUntilTheWallIsShown) {
  LawLoop loop = one_axis("sfa");
  constexpr double kDepth_m = 1e-4;
  loop.tick(0.0, 0.0);
  double force_N = loop.tick(kDepth_m, wall_N(kDepth_m));
  const int ticks = static_cast<int>(std::ceil((kWall_N_per_m - kB_N_per_m) * kDepth_m / kIncrement_N - 1e-6));
  for (int i = 1; i < ticks; ++i) {
    const double next_N = loop.tick(kDepth_m, wall_N(kDepth_m));
    ASSERT_NEAR(next_N, force_N - kIncrement_N, 1e-9);
    force_N = next_N;
  }
  for (int i = 0; i < 10; ++i) loop.tick(kDepth_m, wall_N(kDepth_m));
  EXPECT_EQ(loop.tick(kDepth_m, wall_N(kDepth_m)), wall_N(kDepth_m));
}

TEST(SuccessiveForceAugment, ReleasesAlongTheSpringAndReturnsMoreThanWasStored) {
  LawLoop loop = one_axis("sfa");
  constexpr double kDepth_m = 2e-4;
  constexpr double kStep_m = 2e-5;  // 20 mm/s: a release
  loop.tick(0.0, 0.0);
  double at_m = 0;
  double force_N = 0;
  double kept_J = 0;
  const auto move = [&](double next_m) {
    kept_J -= force_N * (next_m - at_m);
    at_m = next_m;
    force_N = loop.tick(at_m, wall_N(at_m));
  };
  move(kDepth_m);
  for (int i = 0; i < 5000; ++i) move(kDepth_m);
  EXPECT_EQ(force_N, wall_N(kDepth_m));
  for (int i = 1; i <= 9; ++i) {
    move(kDepth_m - i * kStep_m);
    ASSERT_NEAR(force_N, wall_N(kDepth_m) + kB_N_per_m * i * kStep_m, 1e-9) << i;
  }
  move(0.0);
  EXPECT_EQ(force_N, 0.0) << "and it is zero outside";
  // Pressed in one step from outside it stored nothing; it returned the area below the line, each force held a step.
  double returned_J = 0;
  for (int i = 0; i <= 9; ++i) returned_J += (30 - kB_N_per_m * i * kStep_m) * kStep_m;
  EXPECT_NEAR(kept_J, -returned_J, 1e-12);
}

TEST(SuccessiveForceAugment, ShowsASoftWallAsItIs) {
  LawLoop loop = one_axis("sfa");
  loop.tick(0.0, 0.0);
  for (int i = 1; i <= 1000; ++i) {
    const double request_N = -1e3 * i * 1e-5;
    ASSERT_NEAR(loop.tick(i * 1e-5, request_N), request_N, 1e-9) << i;
  }
}

TEST(SuccessiveForceAugment, NeverGivesMoreThanTheLargestForce) {
  LawLoop loop("sfa", Matrix::Constant(1, 1, 30), {.force_N_max = 10});
  loop.tick(0.0, 0.0);
  for (int i = 1; i <= 1000; ++i) ASSERT_GE(loop.tick(i * 1e-5, wall_N(i * 1e-5)), -10.0) << i;
  EXPECT_EQ(loop.tick(1e-2, wall_N(1e-2)), -10.0);
}

TEST(SuccessiveForceAugment, BeginsAgainWithEachContact) {
  LawLoop loop = one_axis("sfa");
  for (int contact = 0; contact < 2; ++contact) {
    loop.tick(0.0, 0.0);
    EXPECT_NEAR(loop.tick(1e-4, wall_N(1e-4)), -3.0, 1e-9);
    for (int i = 0; i < 3000; ++i) loop.tick(1e-4, wall_N(1e-4));
  }
  EXPECT_EQ(loop.tick(1e-4, 15.0), 0.0) << "from the other side, at rest";
  EXPECT_DOUBLE_EQ(loop.tick(1e-4, 15.0), kIncrement_N);
}

TEST(SuccessiveForceAugment, LetsTheDampingOfTheConfigurationChooseTheSpring) {
  Matrix damping = 30 * Matrix::Identity(2, 2);
  damping(1, 1) = 6;
  LawLoop loop("sfa", damping);
  const auto at = [](double x, double y) { return Vector{{x, y}}; };
  loop.tick(at(0, 0), at(0, 0));
  EXPECT_NEAR(loop.tick(at(0, 1e-4), at(0, -15))[1], -6e3 * 1e-4, 1e-9);
}

TEST(SuccessiveForceAugment, ShowsAHandTheWallInTheEnd) {
  for (const double hand_N_per_m : {200.0, 500.0, 1000.0}) {
    const auto result = test::press({.law = "sfa", .hand_N_per_m = hand_N_per_m});
    EXPECT_NEAR(result.shown_N_per_m, kWall_N_per_m, 0.05 * kWall_N_per_m) << hand_N_per_m;
  }
}

TEST(SuccessiveForceAugment, ShowsItThroughAnEncoderAndWithLateAnswersToo) {
  for (const int late_ticks : {1, 2}) {
    const auto result = test::press({.law = "sfa", .late_ticks = late_ticks, .encoder_m = 15e-6});
    EXPECT_NEAR(result.shown_N_per_m, kWall_N_per_m, 0.06 * kWall_N_per_m) << late_ticks;
    EXPECT_LT(result.ripple_N, 1.01 * kB_N_per_m * 15e-6) << "a step of the spring";
  }
}

TEST(SuccessiveForceAugment, HasNoContactAfterALostReading) {
  LawLoop loop = one_axis("sfa");
  loop.tick(0.0, 0.0);
  for (int i = 0; i < 3000; ++i) loop.tick(1e-4, wall_N(1e-4));
  EXPECT_EQ(loop.tick(std::nan(""), -5.0), 0.0);
  EXPECT_EQ(loop.tick(1e-4, wall_N(1e-4)), 0.0) << "the step is unknown";
  EXPECT_DOUBLE_EQ(loop.tick(1e-4, wall_N(1e-4)), -kIncrement_N);
}

TEST(SuccessiveForceAugment, WorksWithAClockThatStandsStill) {
  LawLoop late = one_axis("sfa");
  LawLoop punctual = one_axis("sfa");
  for (const double interval_s : {1e-3, 0.0, -1.0, 1e300, std::nan(""), 5e-3, 1e-3}) {
    late.set_interval(interval_s);
    EXPECT_EQ(late.tick(1e-4, -1.0), punctual.tick(1e-4, -1.0)) << interval_s;
  }
}

TEST(SuccessiveForceAugment, StaysFiniteForHardRequests) { test::expect_finite_for_hard_requests("sfa"); }

}  // namespace
}  // namespace forcebound::baselines
