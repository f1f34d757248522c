// `tdpa`: energy that the environment returns beyond what it took in is damped, a step later and at most with
// alpha_max.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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

constexpr const char* kTimeDomainPassivity = "tdpa";

const control::LawParameters kAnyDamping{{"alpha_max_per_b", 1e3}};
const control::LawParameters k2002{{"variant", 2002}, {"alpha_max_per_b", 1e3}};

TEST(TimeDomainPassivity, DoesNotDampAnEnvironmentThatTakesInMoreThanItReturns) {
  for (const double year : {2002.0, 2004.0}) {
    LawLoop loop = one_axis(kTimeDomainPassivity, {{"variant", year}});
    for (int i = 0; i <= 1000; ++i) {
      const double depth_m = i * 1e-5;
      ASSERT_EQ(loop.tick(depth_m, -1000 * depth_m), -1000 * depth_m) << year << ", " << i;
    }
    EXPECT_NEAR(loop.energy_J(), 0.5 * 1000 * 1e-4, 1e-4) << year;
  }
}

TEST(TimeDomainPassivity, ObservesExactlyWhatAHeldForceTook) {
  LawLoop loop = one_axis(kTimeDomainPassivity);
  loop.tick(0.0, 0.0);
  ASSERT_EQ(loop.tick(1e-3, -2.0), -2.0);
  ASSERT_EQ(loop.tick(4e-3, -1.0), -1.0);
  EXPECT_NEAR(loop.energy_J(), 2.0 * 3e-3, 1e-15);
}

TEST(TimeDomainPassivity, Of2002ObservesTheStepBeforeTheForce) {
  LawLoop loop = one_axis(kTimeDomainPassivity, {{"variant", 2002}});
  loop.tick(0.0, 0.0);
  loop.tick(1e-3, -2.0);
  loop.tick(4e-3, -1.0);
  EXPECT_NEAR(loop.energy_J(), 2.0 * 1e-3, 1e-15);
}

TEST(TimeDomainPassivity, GivesNothingToAMotionThatGoesOn) {
  // An active environment pushes along the motion; the damper takes all of it from the next step of the same speed.
  for (const control::LawParameters& parameters : {kAnyDamping, k2002}) {
    LawLoop loop = one_axis(kTimeDomainPassivity, parameters);
    for (int i = 0; i <= 100; ++i) loop.tick(i * 1e-4, i < 2 ? 0.0 : 3.0);
    EXPECT_NEAR(loop.energy_J(), 0.0, 1e-15);
  }
}

TEST(TimeDomainPassivity, DampsTheMissingEnergy) {
  LawLoop loop = one_axis(kTimeDomainPassivity, kAnyDamping);
  loop.tick(0.0, 0.0);
  loop.tick(0.0, 5.0);  // stands still: nothing to damp with
  const double force_N = loop.tick(1e-3, 5.0);
  EXPECT_NEAR(loop.energy_J(), -5e-3, 1e-15);
  // alpha v T = 2 * 5 mJ / 1 mm: what was given, and what would be
  EXPECT_NEAR(force_N, 5.0 - 10.0, 1e-12);
  loop.tick(2e-3, 0.0);
  EXPECT_NEAR(loop.energy_J(), 0.0, 1e-15);
}

TEST(TimeDomainPassivity, AddsNoMoreDampingThanItMay) {
  for (const double share : {0.0, 0.5, 1.0}) {
    LawLoop loop = one_axis(kTimeDomainPassivity, {{"alpha_max_per_b", share}});
    loop.tick(0.0, 0.0);
    loop.tick(0.0, 1e3);
    EXPECT_NEAR(loop.tick(1e-4, 1e3), 1e3 - share * kDamping_N_s_per_m * 1e-4 / kPeriod_s, 1e-9) << share;
  }
}

TEST(TimeDomainPassivity, DampsNothingBelowTheFloor) {
  const control::LawParameters parameters{{"velocity_floor_m_per_s", 0.01}};
  LawLoop loop = one_axis(kTimeDomainPassivity, parameters);
  loop.tick(0.0, 0.0);
  EXPECT_EQ(loop.tick(0.9e-5, 5.0), 5.0);
  EXPECT_LT(loop.tick(2.1e-5, 5.0), 5.0);
}

TEST(TimeDomainPassivity, HasAFloorThatAnEncodersStepPasses) {
  control::DeviceFacts facts;
  facts.damping = Matrix::Identity(1, 1);
  facts.encoder_step = Vector::Constant(1, 15e-6);
  const auto floor = [&] {
    return shipped_laws().parameters(kTimeDomainPassivity, facts).at("velocity_floor_m_per_s");
  };
  EXPECT_DOUBLE_EQ(floor(), 0.5 * 15e-6 / kPeriod_s);
  facts.cartesian = false;
  EXPECT_EQ(floor(), 0.0) << "a joint's step is no speed of the tip";
}

TEST(TimeDomainPassivity, DampsAlongTheForceOrAlongTheMotion) {
  const Matrix damping = to_matrix({{10, 0, 0}, {0, 10, 0}, {0, 0, 40}});
  const Vector push = to_vector({4, 0, 0});
  const Vector step = to_vector({1e-3, 0, 1e-3});
  const auto force = [&](double weighting) {
    LawLoop loop(kTimeDomainPassivity, damping, {.parameters = {{"weighting", weighting}, {"alpha_max_per_b", 1e3}}});
    loop.tick(0 * step, 0 * push);
    return loop.tick(step, push);
  };
  EXPECT_NEAR(force(0).norm(), 0.0, 1e-12) << "all that it would give is taken from the force itself";
  const Vector weighted = force(1) - push;
  EXPECT_NEAR(weighted.dot(step), -push.dot(step), 1e-15) << "it takes as much";
  EXPECT_NEAR(weighted[1], 0.0, 1e-15);
  EXPECT_NEAR(weighted[2] / weighted[0], 4.0, 1e-12) << "along b v";
}

TEST(TimeDomainPassivity, ObservesTranslationAndRotationApart) {
  LawLoop loop(kTimeDomainPassivity, Matrix::Identity(6, 6), {.parameters = kAnyDamping});
  Vector position = Vector::Zero(6);
  loop.tick(position, Vector::Zero(6));
  Vector step = Vector::Constant(6, 1e-3);
  Vector request = Vector::Zero(6);
  request.head(3).setConstant(-10);  // takes
  request.tail(3).setConstant(2);    // gives less than that
  const Vector force = loop.tick(position + step, request);
  EXPECT_EQ(force.head(3), request.head(3));
  EXPECT_NEAR(force.tail(3).norm(), 0.0, 1e-12);
}

TEST(TimeDomainPassivity, IsNotPassiveAgainstAnAdversary) {
  // Not passive: a force that begins at standstill extracts energy.
  for (const double weighting : {0.0, 1.0}) {
    for (const double year : {2002.0, 2004.0}) {
      LawLoop loop = one_axis(kTimeDomainPassivity, {{"variant", year}, {"weighting", weighting}});
      const Matrix damping = Matrix::Constant(1, 1, kDamping_N_s_per_m);
      const test::Extraction result =
          test::play({.dampings = [&](int) { return damping; },
                      .law = [&](const auto& x, const auto& f, const auto&) { return loop.tick(x, f); }});
      EXPECT_LT(result.least_J, -0.25L * result.turnover_J) << "year " << year << ", weighting " << weighting;
    }
  }
}

TEST(TimeDomainPassivity, StopsWhatAWallTooStiffWouldDo) { test::expect_calms_a_wall_too_stiff(kTimeDomainPassivity); }

TEST(TimeDomainPassivity, StaysFiniteForHardRequests) { test::expect_finite_for_hard_requests(kTimeDomainPassivity); }

TEST(TimeDomainPassivity, ChargesTheWorstOfWhatNobodySaw) {
  LawLoop loop = one_axis(kTimeDomainPassivity);
  loop.tick(0.0, 0.0);
  ASSERT_EQ(loop.tick(1e-3, -3.0), -3.0);
  EXPECT_EQ(loop.tick(std::nan(""), -3.0), 0.0);
  EXPECT_NEAR(loop.energy_J(), -9.0 / (4 * kDamping_N_s_per_m / kPeriod_s), 1e-15);
  loop.tick(5e-3, -3.0);
  loop.tick(6e-3, -3.0);
  EXPECT_NEAR(loop.energy_J(), 3e-3 - 9.0 / (4 * kDamping_N_s_per_m / kPeriod_s), 1e-15);
}

std::string refusal_of_choices(const control::LawParameters& parameters) {
  return shipped_laws().refusal(kTimeDomainPassivity, test::ideal_device(1), {.parameters = parameters});
}

TEST(TimeDomainPassivity, RefusesChoicesThatItDoesNotHave) {
  EXPECT_EQ(refusal_of_choices({{"variant", 2003}}), "law 'tdpa': variant must be 2002 or 2004, got 2003");
  EXPECT_EQ(refusal_of_choices({{"weighting", 2}}), "law 'tdpa': weighting must be 0 or 1, got 2");
  EXPECT_EQ(refusal_of_choices({{"alpha_max_per_b", -1}}), "law 'tdpa': alpha_max_per_b must be 0 to 1000, got -1");
  EXPECT_EQ(refusal_of_choices({{"velocity_floor_m_per_s", -1}}),
            "law 'tdpa': velocity_floor_m_per_s must be >= 0, got -1");
}

}  // namespace
}  // namespace forcebound::baselines
