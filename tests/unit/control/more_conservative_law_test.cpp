#include "forcebound/control/more_conservative_law.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/support/ideal_device.hpp"
#include "tests/support/published_law_checks.hpp"

namespace forcebound::control {
namespace {

using test::kB_N_per_m;
using test::kDamping_N_s_per_m;
using test::LawLoop;
using test::one_axis;
using test::to_matrix;
using test::to_vector;

constexpr const char* kMoreConservative = "fba-more";

/// Free motion towards a wall that begins exactly at a reading.
void approach(LawLoop& loop) {
  for (int i = -50; i <= 0; ++i) loop.tick(i * 2e-5, 0.0);
}

TEST(MoreConservativeLaw, AgreesWithTheReferenceOnRandomRuns) {
  for (const int degrees_of_freedom : {1, 2, 3, 4, 5, 6}) {
    for (const bool damping_changes : {false, true}) {
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        test::expect_agreement(kMoreConservative, test::more_conservative_reference,
                               {.seed = seed,
                                .degrees_of_freedom = degrees_of_freedom,
                                .damping_changes = damping_changes,
                                .motion_m = 3e-4});
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(MoreConservativeLaw, IsPassiveAgainstAnyAdversary) {
  test::expect_passive_against_any_adversary(kMoreConservative);
}

TEST(MoreConservativeLaw, NeverChangesTheDirection) { test::expect_direction_kept(kMoreConservative); }

TEST(MoreConservativeLaw, StaysFiniteForHardRequests) { test::expect_finite_for_hard_requests(kMoreConservative); }

TEST(MoreConservativeLaw, ShowsAtMostTwiceDampingOverPeriod) {
  for (const double stiffness_N_per_m : {1e2, 1e4, 5e4, 6e4, 8e4, 1.5e5, 1e9}) {
    SCOPED_TRACE(stiffness_N_per_m);
    LawLoop loop = one_axis(kMoreConservative);
    approach(loop);
    const double shown_N_per_m = std::min(stiffness_N_per_m, 2 * kDamping_N_s_per_m / 1e-3);
    for (int i = 1; i <= 2000; ++i) {
      // In to 1 mm, back to 0.2 mm and in again, at no steady speed.
      const double depth_m = 6e-4 - 4e-4 * std::cos(i * 0.02) - 2e-4 * std::exp(-i * 0.01);
      const double force_N = loop.tick(depth_m, -stiffness_N_per_m * depth_m);
      ASSERT_NEAR(force_N, -shown_N_per_m * depth_m, 1e-9 * shown_N_per_m * depth_m) << "tick " << i;
    }
  }
}

TEST(MoreConservativeLaw, IsTransparentWhereverTheRequestNeverNeedsMoreThanThereIs) {
  LawLoop loop = one_axis(kMoreConservative);
  approach(loop);
  for (int i = 1; i < 5000; ++i) {
    const double depth_m = 5e-3 * (1.1 + std::sin(i * 0.01)) * std::min(1.0, i * 1e-3);
    const double request_N = -0.9 * 2 * kB_N_per_m * depth_m;
    ASSERT_EQ(loop.tick(depth_m, request_N), request_N) << "tick " << i;
  }
}

TEST(MoreConservativeLaw, CreditsOfASoftWallOnlyTheShareItNeeds) {
  for (const double stiffness_N_per_m : {1e3, 1e4, 3e4, 5e4}) {
    LawLoop loop = one_axis(kMoreConservative);
    approach(loop);
    for (int i = 1; i <= 20000; ++i) loop.tick(i * 1e-6, -stiffness_N_per_m * i * 1e-6);
    const double share = stiffness_N_per_m / (2 * kB_N_per_m);
    EXPECT_NEAR(loop.xi(), share, 1e-3 * share) << stiffness_N_per_m;
  }
}

TEST(MoreConservativeLaw, ForgetsFreeSpace) {
  LawLoop loop = one_axis(kMoreConservative);
  for (int i = 0; i <= 1000; ++i) loop.tick(i * 1e-3, 0.0);
  loop.tick(1.0, 0.0);
  EXPECT_EQ(loop.energy_J(), 0.0);
  EXPECT_EQ(loop.xi(), 1.0);
  EXPECT_EQ(loop.tick(1.0, 5.0), 0.0);
  EXPECT_NEAR(loop.tick(1.0 + 1e-5, -1e6), -2 * kB_N_per_m * 1e-5, 1e-9);
}

TEST(MoreConservativeLaw, RemembersWhatAForceReserved) {
  LawLoop loop = one_axis(kMoreConservative);
  loop.tick(0.0, 0.0);
  EXPECT_EQ(loop.tick(1e-4, -1.0), -1.0);
  const double available_J = kB_N_per_m * 1e-8;
  EXPECT_NEAR(loop.energy_J(), available_J, 1e-18);
  EXPECT_NEAR(loop.xi(), 1.0 / (4 * kB_N_per_m) / available_J, 1e-15);
  loop.tick(1e-4, -1.0);  // standing still neither earns nor costs
  EXPECT_NEAR(loop.energy_J(), available_J, 1e-18);
}

TEST(MoreConservativeLaw, HasNothingLeftAfterTheMotionThatTakesMost) {
  // Numbers that a double holds exactly: A is exactly zero, not nearly.
  LawLoop loop(kMoreConservative, Matrix::Constant(1, 1, 1.0), {.period_s = std::exp2(-10)});
  loop.tick(0.0, 0.0);
  EXPECT_EQ(loop.tick(std::exp2(-10), 2.0), 2.0);
  EXPECT_EQ(loop.xi(), 1.0);
  EXPECT_EQ(loop.tick(std::exp2(-9), 2.0), 0.0);
  EXPECT_EQ(loop.energy_J(), 0.0);
  EXPECT_EQ(loop.xi(), 1.0);
  EXPECT_EQ(loop.tick(std::exp2(-9), 2.0), 0.0);
  EXPECT_EQ(loop.tick(std::exp2(-9) + std::exp2(-10), 2.0), 2.0) << "did not recover";
}

TEST(MoreConservativeLaw, RepaysWhatAForceHeldForLongerThanAPeriodMayHaveTaken) {
  const Damping damping = Damping::from_matrix(Matrix::Constant(1, 1, 30.0));
  MoreConservativeLaw law(1, 1e-3);
  const auto move_to = [&](double x_m, double interval_s, double held_s) {
    Motion motion;
    motion.interval_s = interval_s;
    motion.held_s = held_s;
    motion.position = Vector::Constant(1, x_m);
    motion.damping = &damping;
    law.credit(motion);
  };
  constexpr double kAlways = std::numeric_limits<double>::infinity();
  move_to(0, 0, kAlways);
  law.commit(Vector::Zero(1));
  move_to(1e-3, 1e-3, kAlways);
  const double available_J = law.energy_J();  // 30 mJ
  const Vector force = law.bound(Vector::Constant(1, 1e6));
  law.commit(force);
  // The device let go after two periods: the worst motion has taken twice the reserve.
  move_to(0.1, 20e-3, 2e-3);
  EXPECT_EQ(law.energy_J(), 0.0);
  law.commit(Vector::Zero(1));
  move_to(0.1 + 0.5e-3, 1e-3, kAlways);
  EXPECT_EQ(law.energy_J(), 0.0) << "a quarter of the debt is repaid, nothing is to spend";
  law.commit(Vector::Zero(1));
  move_to(0.1 + 2.5e-3, 1e-3, kAlways);
  EXPECT_NEAR(law.energy_J(), 4 * available_J - 0.75 * available_J, 1e-12);
}

TEST(MoreConservativeLaw, HasNothingToSpendAfterAnIntervalThatNoClockMeasured) {
  const Damping damping = Damping::from_matrix(Matrix::Constant(1, 1, 30.0));
  for (const double interval_s : {0.0, -1e-3, 1e308, std::numeric_limits<double>::quiet_NaN()}) {
    SCOPED_TRACE(interval_s);
    MoreConservativeLaw law(1, 1e-3);
    const auto move_to = [&](double x_m, double after_s) {
      Motion motion;
      motion.interval_s = after_s;
      motion.position = Vector::Constant(1, x_m);
      motion.damping = &damping;
      law.credit(motion);
    };
    move_to(0, 1e-3);
    move_to(1e-3, 1e-3);
    law.commit(law.bound(Vector::Constant(1, 1e6)));
    move_to(1, interval_s);
    EXPECT_EQ(law.energy_J(), 0.0);
    law.commit(Vector::Zero(1));
    move_to(1.001, 1e-3);
    EXPECT_NEAR(law.energy_J(), 30e-3, 1e-12) << "no debt: the reserve was all that a period can take";
  }
}

TEST(MoreConservativeLaw, SurvivesAShareNextToNothingForAMillionTicks) {
  for (const auto& [request_N, ticks] : {std::pair{1e-140, 1000}, {1.1e-150, 1'000'000}}) {
    LawLoop loop = one_axis(kMoreConservative);
    loop.tick(0.0, 0.0);
    loop.tick(1e-4, request_N);
    const double available_J = loop.energy_J();
    for (int i = 0; i < ticks; ++i) {
      ASSERT_EQ(loop.tick(1e-4 + (i % 100) * 1e-5, request_N), request_N) << i;
      ASSERT_LE(loop.xi(), 1e-200);
    }
    EXPECT_NEAR(loop.energy_J(), available_J, 1e-12 * available_J);
    const double most_N = std::sqrt(4 * available_J * kB_N_per_m);
    EXPECT_NEAR(loop.tick(1e-4, 1e6), most_N, 1e-9 * most_N);
  }
}

TEST(MoreConservativeLaw, IsPassiveWithConditionNumber1e12) {
  // Long axis 1e6, short one 1e-6, 45 degrees off the axes; 0.5 (1e6 + 1e-6) is exact enough to keep the ratio.
  const Matrix damping = to_matrix({{5e5 + 5e-7, 5e5 - 5e-7}, {5e5 - 5e-7, 5e5 + 5e-7}});
  for (const char* name : {"fba-less", kMoreConservative}) {
    LawLoop loop(name, damping);
    const test::Extraction result =
        test::play({.seed = 3,
                    .degrees_of_freedom = 2,
                    .dampings = [&](int) { return damping; },
                    .law = [&](const auto& x, const auto& f, const auto&) { return loop.tick(x, f); }});
    // Rounding of a matrix is relative to its largest eigenvalue.
    EXPECT_GE(result.least_J, -1e-9L * result.turnover_J) << name;
    EXPECT_TRUE(std::isfinite(loop.energy_J()));
  }
}

}  // namespace
}  // namespace forcebound::control
