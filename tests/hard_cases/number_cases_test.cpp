// Cases 1 to 3: numbers at the limits of a double, and damping near zero, for every law.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "forcebound/device/load_device.hpp"
#include "tests/hard_cases/bounding_laws.hpp"
#include "tests/support/published_law_checks.hpp"
#include "tests/support/special_numbers.hpp"

namespace forcebound::control {
namespace {

using test::kInfinity;
using test::kNaN;
using test::LawLoop;
using test::to_vector;

/// b = Q diag(1e6, 1e-6) Q' with Q turned by 45 degrees: condition number 1e12, to the bit symmetric.
Matrix nearly_singular() { return test::to_matrix({{5e5 + 5e-7, 5e5 - 5e-7}, {5e5 - 5e-7, 5e5 + 5e-7}}); }

class HardCase01 : public testing::TestWithParam<std::string> {};

TEST_P(HardCase01, RequestsOfAnySizeGiveAFiniteForceAndTheLawRecovers) {
  test::expect_finite_for_hard_requests(GetParam());
}

TEST_P(HardCase01, EveryRequestAndReadingThatIsNotFiniteIsZeroForceAndCounted) {
  LawLoop loop(GetParam(), test::full_damping(3, 1), {.force_N_max = 10});
  int tick = 0;
  const auto move = [&] { return Vector::Constant(3, 1e-3 * (++tick % 2)); };
  for (int i = 0; i < 20; ++i) (void)loop.tick(move(), to_vector({1, 2, 3}));
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      Vector request = to_vector({1, 2, 3});
      request[axis] = bad;
      EXPECT_EQ(loop.tick(move(), request), Vector::Zero(3)) << bad;
      Vector reading = move();
      reading[axis] = bad;
      const double energy_J = loop.energy_J();
      EXPECT_EQ(loop.tick(reading, to_vector({1, 2, 3})), Vector::Zero(3)) << bad;
      EXPECT_LE(loop.energy_J(), energy_J);
    }
  }
  EXPECT_EQ(loop.counts().requests_not_finite, 9U);
  EXPECT_EQ(loop.counts().readings_not_finite, 9U);
  for (int i = 0; i < 20; ++i) (void)loop.tick(move(), to_vector({0, 0, 0}));
  EXPECT_EQ(loop.tick(move(), to_vector({0.1, 0.2, 0.3})), to_vector({0.1, 0.2, 0.3})) << "did not recover";
}

TEST_P(HardCase01, ReadingsAsFarOutAsTheirSquaresGoLeaveTheLedgerANumber) {
  LawLoop loop(GetParam(), Matrix::Constant(1, 1, 30), {.force_N_max = 10});
  for (int i = 0; i < 100; ++i) {
    for (const double far_m : {1e100, 1e150, 1e151, 1e153, 1e200, std::numeric_limits<double>::max()}) {
      ASSERT_LE(std::abs(loop.tick(i % 2 == 0 ? far_m : -far_m, 1)), 1);
      ASSERT_TRUE(std::isfinite(loop.energy_J())) << far_m;
    }
  }
  for (int i = 0; i < 20; ++i) (void)loop.tick(1e-3 * (i % 2), 0);
  EXPECT_EQ(loop.tick(0, 1), 1) << "did not recover";
}

INSTANTIATE_TEST_SUITE_P(Laws, HardCase01, testing::ValuesIn(test::bounding_laws()), test::name_of_law);

class HardCase02 : public testing::TestWithParam<std::string> {};

TEST_P(HardCase02, AShareNextToNothingForManyTicksEarnsNothingInSeveralAxes) {
  constexpr int kTicks = 200'000;
  for (const int degrees_of_freedom : {3, 6}) {
    LawLoop loop(GetParam(), test::full_damping(degrees_of_freedom, 2));
    const Vector there = Vector::LinSpaced(degrees_of_freedom, 1e-3, 2e-3);
    const Vector request = Vector::LinSpaced(degrees_of_freedom, 2e-150, 9e-150);
    (void)loop.tick(Vector::Zero(degrees_of_freedom), request);
    // After a request that was cut, the share that is shown may rise by degrees.
    for (int i = 0; i < 20; ++i) (void)loop.tick(there, request);
    const double energy_J = loop.energy_J();
    ASSERT_GT(energy_J, 0.0);
    for (int i = 0; i < kTicks; ++i) ASSERT_EQ(loop.tick(there, request), request) << i;
    EXPECT_LE(loop.energy_J(), energy_J * (1 + 1e-12)) << "at rest nothing is dissipated";
    EXPECT_GE(loop.energy_J(), energy_J * (1 - 1e-12)) << "and such a force takes nothing";
  }
}

TEST_P(HardCase02, NoEnergyAtAllIsNoForceAtAll) {
  LawLoop loop(GetParam(), test::full_damping(3, 3));
  for (int i = 0; i < 1000; ++i) {
    ASSERT_EQ(loop.tick(to_vector({0.1, -0.2, 0.3}), to_vector({1e6, 1, -1e-6})), Vector::Zero(3));
    ASSERT_EQ(loop.energy_J(), 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, HardCase02, testing::ValuesIn(test::bounding_laws()), test::name_of_law);

class HardCase03 : public testing::TestWithParam<std::string> {};

TEST_P(HardCase03, IsPassiveAgainstAnAdversaryWithConditionNumber1e12) {
  const Matrix damping = nearly_singular();
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    LawLoop loop(GetParam(), damping);
    const test::Extraction result = test::play({.seed = seed,
                                                .degrees_of_freedom = 2,
                                                .dampings = [&](int) { return damping; },
                                                .law =
                                                    [&](const Vector& x, const Vector& request, const Matrix&) {
                                                      const Vector force = loop.tick(x, request);
                                                      EXPECT_TRUE(force.allFinite());
                                                      return force;
                                                    }});
    // Rounding of a matrix is relative to its largest eigenvalue.
    EXPECT_GE(result.least_J, -1e-9L * result.turnover_J) << "seed " << seed;
    EXPECT_TRUE(std::isfinite(loop.energy_J()));
  }
}

TEST_P(HardCase03, AnArmOfConditionNumber1e12IsClampedAndGivesFiniteForces) {
  DeviceFacts facts;
  facts.name = "crooked";
  facts.cartesian = false;
  facts.damping = to_vector({1e6, 1e-6}).asDiagonal();
  facts.friction = facts.encoder_step = facts.actuator_step = Vector::Zero(2);
  facts.force_N_max = 10;
  ForceBounder bounder(facts, control::force_bounding_laws().make(GetParam(), facts));
  for (int i = 0; i < 1000; ++i) {
    const double turn = 1e-3 * i;
    Motion motion;
    motion.interval_s = facts.period_s;
    motion.position = motion.joint = Vector::Constant(2, 1e-3 * (i % 2));
    motion.jacobian = test::to_matrix({{std::cos(turn), std::sin(turn)}, {-std::sin(turn), std::cos(turn)}});
    if (i % 10 == 0) motion.jacobian.row(0) = (1 + 1e-15) * motion.jacobian.row(1);
    const Damping damping = Damping::from_joints(motion.jacobian, facts.damping);
    motion.damping = &damping;
    const Vector force = bounder.tick(motion, to_vector({1, -1}));
    ASSERT_TRUE(force.allFinite()) << i;
    ASSERT_LE(force.norm(), 10 * (1 + 1e-12)) << i;
    ASSERT_TRUE(std::isfinite(bounder.law().energy_J())) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, HardCase03, testing::ValuesIn(test::bounding_laws()), test::name_of_law);

TEST(HardCase03, DampingThatIsIndefiniteByRoundingIsRefusedAtSetUp) {
  const Matrix damping = test::to_matrix({{30, 30 + 1e-12}, {30 + 1e-12, 30}});
  EXPECT_THROW((void)Damping::from_matrix(damping), std::invalid_argument);
  try {
    (void)device::parse_device(
        "kind = 'cartesian'\ndegrees_of_freedom = 2\nmass_kg = 0.1\nforce_N_max = 3\n"
        "damping_N_s_per_m = [[30, 30.000000000001], [30.000000000001, 30]]\n",
        "crooked.toml");
    ADD_FAILURE() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("crooked.toml:5"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("positive definite"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace forcebound::control
