// Checks for every law of one port: an arm's singular configurations, ticks without a reading, release.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/law_loop.hpp"

#include "forcebound/baselines/baselines.hpp"

namespace forcebound::baselines {
namespace {

constexpr double kLink_m = 0.13;

class OnePortLaw : public testing::TestWithParam<const char*> {};

/// d position / d joint of two links of 0.13 m and a slide; the links line up where the second joint is 0.
Matrix two_links(const Vector& joint) {
  const double both = joint[0] + joint[1];
  return test::to_matrix({{-kLink_m * (std::sin(joint[0]) + std::sin(both)), -kLink_m * std::sin(both), 0},
                          {kLink_m * (std::cos(joint[0]) + std::cos(both)), kLink_m * std::cos(both), 0},
                          {0, 0, 1}});
}

Vector tip_of(const Vector& joint) {
  const double both = joint[0] + joint[1];
  return test::to_vector(
      {kLink_m * (std::cos(joint[0]) + std::cos(both)), kLink_m * (std::sin(joint[0]) + std::sin(both)), joint[2]});
}

TEST_P(OnePortLaw, StaysFiniteOnAnArmThatPassesSingularConfigurations) {
  constexpr double kForceMax_N = 5;
  control::DeviceFacts facts;
  facts.cartesian = false;
  facts.damping = test::to_matrix({{0.01, 0, 0}, {0, 0.005, 0}, {0, 0, 1}});
  facts.friction = facts.encoder_step = facts.actuator_step = Vector::Zero(3);
  facts.force_N_max = kForceMax_N;
  control::ForceBounder bounder(facts, shipped_laws().make(GetParam(), facts));
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  Vector joint = test::to_vector({0.3, 0.4, 0});
  int felt = 0;
  for (int i = 0; i < 20'000; ++i) {
    joint += 1e-3 * test::to_vector({number(random), number(random), number(random)});
    if (i % 50 == 0) joint[1] = i % 100 == 0 ? 0 : 1e-9 * number(random);
    if (i % 50 == 25) joint[1] = 0.5;
    control::Motion motion;
    motion.interval_s = i % 30 == 0 ? -1e-3 : 1e-3;
    motion.held_s = i % 70 == 0 ? 0.5e-3 : 1;
    motion.joint = i % 90 == 0 ? Vector(std::nan("") * joint) : joint;
    motion.position = tip_of(joint);
    motion.jacobian = two_links(joint);
    const control::Damping damping = control::Damping::from_joints(motion.jacobian, facts.damping);
    motion.damping = &damping;
    const Vector force = bounder.tick(motion, -100 * motion.position + Vector::Constant(3, 20 * number(random)));
    ASSERT_TRUE(force.allFinite()) << i;
    ASSERT_LE(force.norm(), kForceMax_N * (1 + 1e-12)) << i;
    ASSERT_TRUE(std::isfinite(bounder.law().energy_J())) << i;
    felt += force.isZero(0) ? 0 : 1;
  }
  EXPECT_GT(felt, 1000);
}

TEST_P(OnePortLaw, GivesNothingWithoutARequestFromRest) {
  test::LawLoop loop(GetParam(), test::to_matrix({{20, 10}, {10, 20}}));
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(loop.tick(test::to_vector({1e-4 * i, std::sin(i * 0.1)}), Vector::Zero(2)).isZero(0)) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Baselines, OnePortLaw, testing::Values("aol", "eba", "tdpa", "tdpa-priority"));

}  // namespace
}  // namespace forcebound::baselines
