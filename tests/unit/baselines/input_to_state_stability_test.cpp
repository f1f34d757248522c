// `iss`: a spring that passivity forbids is let through; what the transformed force and motion miss is damped.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/ideal_device.hpp"
#include "tests/support/pressed_wall.hpp"
#include "tests/support/published_law_checks.hpp"

#include "forcebound/baselines/baselines.hpp"

namespace forcebound::baselines {
namespace {

using test::kB_N_per_m;
using test::kDamping_N_s_per_m;
using test::kPeriod_s;
using test::LawLoop;
using test::one_axis;

constexpr const char* kIss = "iss";

/// An observer of energy alone.
const control::LawParameters kNoLead{{"variant", 2016}, {"tau_s", 0}, {"mu_N_per_m", 1e9}};

TEST(InputToStateStability, Of2015LeadsTheForceByTau) {
  LawLoop loop = one_axis(kIss, {{"variant", 2015}, {"tau_s", 2 * kPeriod_s}});
  EXPECT_EQ(loop.tick(0.0, 0.0), 0.0);
  EXPECT_NEAR(loop.tick(0.0, -1.0), -3.0, 1e-12);
  EXPECT_NEAR(loop.tick(0.0, -1.0), -1.0, 1e-12);
}

TEST(InputToStateStability, Of2015AsksTheEnvironmentBehindASpringMu) {
  LawLoop loop(kIss, Matrix::Constant(1, 1, kDamping_N_s_per_m),
               {.force_N_max = 30, .parameters = {{"variant", 2015}, {"mu_N_per_m", 1000}}});
  const Vector at_m = Vector::Constant(1, 5e-3);
  EXPECT_EQ(loop.proxy_position(at_m)[0], 5e-3);
  loop.tick(5e-3, -2.0);
  EXPECT_NEAR(loop.proxy_position(at_m)[0], 3e-3, 1e-15);
  loop.tick(5e-3, -200.0);
  EXPECT_NEAR(loop.proxy_position(at_m)[0], 5e-3 - 30e-3, 1e-15) << "no further than the largest force";
  loop.tick(std::nan(""), -2.0);
  EXPECT_EQ(loop.proxy_position(at_m)[0], 5e-3) << "nothing is known of the force";
}

TEST(InputToStateStability, LetsASpringThroughThatPassivityForbids) {
  // Sampled and held, it returns K d^2/2 of every step d: more than the device's damping takes from 2 b/T on.
  const double mu = 8 * kB_N_per_m;  // the standard
  const double stiffness = 0.9 * mu;
  LawLoop loop = one_axis(kIss, {{"variant", 2016}});
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  double at_m = 0;
  double held_N = 0;
  double given_J = 0;
  double dissipated_J = 0;
  loop.tick(0.0, 0.0);
  for (int i = 0; i < 1000; ++i) {
    const double step_m = (i == 999 ? 0.0 : 1e-5 * normal(random)) - at_m;
    given_J += held_N * step_m;
    dissipated_J += kB_N_per_m * step_m * step_m;
    at_m += step_m;
    held_N = loop.tick(at_m, -stiffness * at_m);
    ASSERT_NEAR(held_N, -stiffness * at_m, 1e-9) << i;
    ASSERT_NEAR(loop.energy_J(), (1 - stiffness / mu) * stiffness * at_m * at_m / 2, 1e-12) << i;
  }
  EXPECT_GT(given_J, 3 * dissipated_J);
}

TEST(InputToStateStability, DampsTheMissingEnergy) {
  LawLoop loop = one_axis(kIss, kNoLead);
  loop.tick(0.0, 0.0);
  ASSERT_EQ(loop.tick(0.0, 5.0), 5.0);
  EXPECT_NEAR(loop.tick(1e-3, 5.0), 0.0, 1e-6) << "5 mJ were given: 5 N against a step of 1 mm";
  EXPECT_NEAR(loop.tick(2e-3, 0.0), -5.0, 1e-6);
  loop.tick(3e-3, 0.0);
  EXPECT_NEAR(loop.energy_J(), 0.0, 1e-9);
}

TEST(InputToStateStability, AddsNoMoreDampingThanItMay) {
  for (const double share : {0.0, 0.5, 1.0}) {
    control::LawParameters parameters = kNoLead;
    parameters["alpha_max_per_b"] = share;
    LawLoop loop = one_axis(kIss, parameters);
    loop.tick(0.0, 0.0);
    loop.tick(0.0, 1e3);
    EXPECT_NEAR(loop.tick(1e-4, 1e3), 1e3 - share * kDamping_N_s_per_m * 1e-4 / kPeriod_s, 1e-9) << share;
  }
}

TEST(InputToStateStability, IsNotPassiveAgainstAnAdversary) {
  for (const double year : {2015.0, 2016.0}) {
    LawLoop loop = one_axis(kIss, {{"variant", year}});
    const Matrix damping = Matrix::Constant(1, 1, kDamping_N_s_per_m);
    const test::Extraction result =
        test::play({.dampings = [&](int) { return damping; },
                    .law = [&](const auto& x, const auto& f, const auto&) { return loop.tick(x, f); }});
    EXPECT_LT(result.least_J, -0.1L * result.turnover_J) << year;
  }
}

TEST(InputToStateStability, StaysFiniteForHardRequests) { test::expect_finite_for_hard_requests(kIss); }

TEST(InputToStateStability, ChargesTheWorstOfWhatNobodySaw) {
  LawLoop loop = one_axis(kIss, kNoLead);
  loop.tick(0.0, 0.0);
  ASSERT_EQ(loop.tick(1e-3, -3.0), -3.0);
  EXPECT_EQ(loop.tick(std::nan(""), -3.0), 0.0);
  EXPECT_NEAR(loop.energy_J(), -9.0 / (4 * kDamping_N_s_per_m / kPeriod_s), 1e-15);
}

TEST(InputToStateStability, RestsOnAWallThatRingsWithoutIt) {
  const test::PressedWall wall{.law = "none", .stiffness_N_per_m = 8e4, .hand_N_per_m = 2000};
  EXPECT_GT(test::press(wall).ripple_N, 10);
  test::PressedWall with = wall;
  with.law = kIss;
  const test::PressedWallResult result = test::press(with);
  EXPECT_LT(result.ripple_N, 1e-6);
  EXPECT_GT(result.least_P_J, -1e-6);
  const double series_N_per_m = 1 / (1 / 8e4 + 1 / (8 * kB_N_per_m));
  EXPECT_NEAR(result.shown_N_per_m, series_N_per_m, 1e-3 * series_N_per_m) << "wall and mu, one behind the other";
}

TEST(InputToStateStability, HasItsStandardsFromTheDevice) {
  const control::LawParameters standard = shipped_laws().parameters(kIss, test::ideal_device(1));
  EXPECT_NEAR(standard.at("mu_N_per_m") * standard.at("tau_s"), 4 * kDamping_N_s_per_m, 1e-9);
  EXPECT_EQ(shipped_laws().refusal(kIss, test::ideal_device(1), {.parameters = {{"variant", 2017}}}),
            "law 'iss': variant must be 2015 or 2016, got 2017");
}

}  // namespace
}  // namespace forcebound::baselines
