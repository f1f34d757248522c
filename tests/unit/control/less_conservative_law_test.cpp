#include "forcebound/control/less_conservative_law.hpp"

#include <gtest/gtest.h>

#include <cmath>

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

constexpr const char* kLessConservative = "fba-less";

TEST(LessConservativeLaw, AgreesWithTheReferenceOnRandomRuns) {
  for (const int degrees_of_freedom : {1, 2, 3, 4, 5, 6}) {
    for (const bool damping_changes : {false, true}) {
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        test::expect_agreement(kLessConservative, test::less_conservative_reference,
                               {.seed = seed,
                                .degrees_of_freedom = degrees_of_freedom,
                                .damping_changes = damping_changes,
                                .motion_m = 1e-4});
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(LessConservativeLaw, IsPassiveAgainstAnyAdversary) {
  test::expect_passive_against_any_adversary(kLessConservative);
}

TEST(LessConservativeLaw, NeverChangesTheDirection) { test::expect_direction_kept(kLessConservative); }

TEST(LessConservativeLaw, StaysFiniteForHardRequests) { test::expect_finite_for_hard_requests(kLessConservative); }

TEST(LessConservativeLaw, GivesNothingBeforeTheDeviceHasMoved) {
  LawLoop loop = one_axis(kLessConservative);
  EXPECT_EQ(loop.tick(0.1, 5.0), 0.0);
  EXPECT_EQ(loop.tick(0.1, 5.0), 0.0);
  EXPECT_EQ(loop.energy_J(), 0.0);
}

TEST(LessConservativeLaw, SpendsAllThatFreeSpaceSaved) {
  LawLoop loop = one_axis(kLessConservative);
  constexpr int kTicks = 400;
  for (int i = 0; i <= kTicks; ++i) loop.tick(i * 1e-5, 0.0);
  const double saved_J = kTicks * kB_N_per_m * 1e-10;
  EXPECT_NEAR(loop.energy_J(), saved_J, 1e-12);
  EXPECT_NEAR(loop.tick(kTicks * 1e-5, -1e6), -std::sqrt(4 * saved_J * kB_N_per_m), 1e-9);
}

TEST(LessConservativeLaw, HasNothingLeftAfterTheMotionThatTakesMost) {
  // b = 1 N s/m, T = 2^-10 s, and numbers that a double holds exactly: E is exactly zero, not nearly.
  LawLoop loop(kLessConservative, Matrix::Constant(1, 1, 1.0), {.period_s = std::exp2(-10)});
  loop.tick(0.0, 0.0);
  EXPECT_EQ(loop.tick(std::exp2(-10), 2.0), 2.0);  // E = B d^2 = 2^-10, and f^2 / 4B the same
  EXPECT_EQ(loop.tick(std::exp2(-9), 2.0), 0.0);   // d = f / 2B takes it all
  EXPECT_EQ(loop.energy_J(), 0.0);
}

TEST(LessConservativeLaw, ShowsASoftWallAsItIs) {
  LawLoop loop = one_axis(kLessConservative);
  for (int i = 0; i < 1000; ++i) {
    const double depth_m = 5e-3 * std::sin(i * 2e-3);
    const double request_N = -0.5 * kB_N_per_m * depth_m;
    ASSERT_EQ(loop.tick(depth_m, request_N), request_N) << i;
  }
}

TEST(LessConservativeLaw, AllowsWhatItBoundsTo) {
  LessConservativeLaw law(1, 1e-3);
  const Damping damping = Damping::from_matrix(Matrix::Constant(1, 1, kDamping_N_s_per_m));
  Motion motion;
  motion.interval_s = 1e-3;
  motion.damping = &damping;
  for (const double position_m : {0.0, 1e-4}) {
    motion.position = Vector::Constant(1, position_m);
    law.credit(motion);
  }
  const Vector most = law.bound(Vector::Constant(1, 1e6));
  EXPECT_TRUE(law.allows(most, 0));
  EXPECT_FALSE(law.allows(1.001 * most, 0));
  EXPECT_TRUE(law.allows(Vector::Zero(1), 0));
}

}  // namespace
}  // namespace forcebound::control
