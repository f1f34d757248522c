// `tdpa-priority`: what the environment returns beyond what it took in is dissipated in one direction first, and what
// that leaves in the others.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/support/ideal_device.hpp"
#include "tests/support/pressed_wall.hpp"
#include "tests/support/published_law_checks.hpp"

#include "forcebound/baselines/baselines.hpp"

namespace forcebound::baselines {
namespace {

using test::kDamping_N_s_per_m;
using test::kPeriod_s;
using test::LawLoop;
using test::one_axis;
using test::to_matrix;
using test::to_vector;

constexpr const char* kPrioritised = "tdpa-priority";

const Vector kAlongX_N = to_vector({4, 0, 0});
const Vector kDiagonal_m = to_vector({1e-3, 0, 1e-3});

/// b T^-1 d is (10, 0, 40) N for the step above, of which (10, 0, 0) N is along the push.
LawLoop three_axes(const control::LawParameters& parameters) {
  return {kPrioritised, to_matrix({{10, 0, 0}, {0, 10, 0}, {0, 0, 40}}), {.parameters = parameters}};
}

void expect_force(const Vector& force, const std::vector<double>& expected_N) {
  EXPECT_NEAR((force - to_vector(expected_N)).norm(), 0.0, 1e-12) << force.transpose();
}

TEST(PrioritisedDissipation, DampsNothingWhileTheEnvironmentTakesInMoreThanItReturns) {
  LawLoop loop = one_axis(kPrioritised);
  for (int i = 0; i <= 1000; ++i) ASSERT_EQ(loop.tick(i * 1e-5, -1e-2 * i), -1e-2 * i) << i;
  EXPECT_NEAR(loop.energy_J(), 0.5 * 1000 * 1e-4, 1e-4);
}

TEST(PrioritisedDissipation, TakesAllFromTheForceFirst) {
  LawLoop loop = three_axes({});
  loop.tick(0 * kDiagonal_m, 0 * kAlongX_N);
  expect_force(loop.tick(kDiagonal_m, kAlongX_N), {0, 0, 0});
}

TEST(PrioritisedDissipation, KeepsTheForceWhereItDampsAcrossItFirst) {
  LawLoop loop = three_axes({{"first", 1}});
  loop.tick(0 * kDiagonal_m, 0 * kAlongX_N);
  // 4 mJ of the 40 mJ that the device's own damping takes across the force
  expect_force(loop.tick(kDiagonal_m, kAlongX_N), {4, 0, -4});
}

TEST(PrioritisedDissipation, LeavesToTheSecondDirectionWhatTheFirstCannotTake) {
  LawLoop across = three_axes({{"first", 1}, {"alpha_max_per_b", 0.05}});
  across.tick(0 * kDiagonal_m, 0 * kAlongX_N);
  expect_force(across.tick(kDiagonal_m, kAlongX_N), {3.5, 0, -2});

  LawLoop along = three_axes({{"alpha_max_per_b", 0.2}});
  along.tick(0 * kDiagonal_m, 0 * kAlongX_N);
  along.tick(0 * kDiagonal_m, kAlongX_N);  // stands still: nothing to damp with
  // 8 mJ: 4 that were given, 4 that would be, of which 2 N along the force take 2.
  expect_force(along.tick(kDiagonal_m, kAlongX_N), {2, 0, -6});
  along.tick(2 * kDiagonal_m, 0 * kAlongX_N);
  EXPECT_NEAR(along.energy_J(), 0.0, 1e-15);
}

TEST(PrioritisedDissipation, IsOneDamperOfTheLimitWhereBothDirectionsReachIt) {
  for (const double first : {0.0, 1.0}) {
    LawLoop loop = three_axes({{"first", first}, {"alpha_max_per_b", 0.5}});
    loop.tick(0 * kDiagonal_m, 0 * kAlongX_N);
    loop.tick(0 * kDiagonal_m, 25 * kAlongX_N);
    expect_force(loop.tick(kDiagonal_m, to_vector({-5, 0, 0})), {-5 - 0.5 * 10, 0, -0.5 * 40});
  }
}

TEST(PrioritisedDissipation, IsTheOnePortApproachOnOneAxis) {
  LawLoop loop = one_axis(kPrioritised);
  LawLoop one_port = one_axis("tdpa");
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 1000; ++i) {
    const double position_m = 1e-3 * normal(random);
    const double request_N = normal(random);
    ASSERT_NEAR(loop.tick(position_m, request_N), one_port.tick(position_m, request_N), 1e-12) << i;
  }
}

TEST(PrioritisedDissipation, DampsNothingBelowTheFloor) {
  LawLoop loop = one_axis(kPrioritised, {{"velocity_floor_m_per_s", 0.01}});
  loop.tick(0.0, 0.0);
  EXPECT_EQ(loop.tick(0.9e-5, 5.0), 5.0);
  EXPECT_LT(loop.tick(2.1e-5, 5.0), 5.0);
}

TEST(PrioritisedDissipation, IsNotPassiveAgainstAnAdversary) {
  for (const double first : {0.0, 1.0}) {
    LawLoop loop = one_axis(kPrioritised, {{"first", first}});
    const Matrix damping = Matrix::Constant(1, 1, kDamping_N_s_per_m);
    const test::Extraction result =
        test::play({.dampings = [&](int) { return damping; },
                    .law = [&](const auto& x, const auto& f, const auto&) { return loop.tick(x, f); }});
    EXPECT_LT(result.least_J, -0.25L * result.turnover_J) << first;
  }
}

TEST(PrioritisedDissipation, StopsWhatAWallTooStiffWouldDo) { test::expect_calms_a_wall_too_stiff(kPrioritised); }

TEST(PrioritisedDissipation, StaysFiniteForHardRequests) { test::expect_finite_for_hard_requests(kPrioritised); }

TEST(PrioritisedDissipation, ChargesTheWorstOfWhatNobodySaw) {
  LawLoop loop = one_axis(kPrioritised);
  loop.tick(0.0, 0.0);
  ASSERT_EQ(loop.tick(1e-3, -3.0), -3.0);
  EXPECT_EQ(loop.tick(std::nan(""), -3.0), 0.0);
  EXPECT_NEAR(loop.energy_J(), -9.0 / (4 * kDamping_N_s_per_m / kPeriod_s), 1e-15);
}

TEST(PrioritisedDissipation, RefusesAnOrderThatItDoesNotHave) {
  EXPECT_EQ(shipped_laws().refusal(kPrioritised, test::ideal_device(3), {.parameters = {{"first", 2}}}),
            "law 'tdpa-priority': first must be 0 or 1, got 2");
}

}  // namespace
}  // namespace forcebound::baselines
