#include "forcebound/server/robot/friction_step.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/allocation_guard.hpp"

namespace forcebound::server {
namespace {

struct Problem {
  CoordinateMatrix a;
  Coordinates r;
  Coordinates friction;
};

/// As ill-conditioned as an arm's mass matrix, and with frictions from nothing to all of the force.
Problem drawn(std::mt19937_64& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  const Eigen::Index rows = std::uniform_int_distribution<Eigen::Index>(1, 15)(random);
  const auto any = [&](Eigen::Index, Eigen::Index) { return number(random); };
  const CoordinateMatrix mix = CoordinateMatrix::NullaryExpr(rows, rows, any);
  Problem problem;
  problem.a = mix * mix.transpose();
  problem.a.diagonal().array() += 0.01;
  problem.r = Coordinates::NullaryExpr(rows, [&](Eigen::Index) { return 3 * number(random); });
  problem.friction = Coordinates::NullaryExpr(rows, [&](Eigen::Index) { return std::max(0.0, 2 * number(random)); });
  return problem;
}

TEST(FrictionStep, FindsTheVelocityAtWhichFrictionActs) {
  std::mt19937_64 random(1);
  FrictionStep step;
  int sticking = 0;
  for (int game = 0; game < 3000; ++game) {
    SCOPED_TRACE(game);
    const Problem problem = drawn(random);
    step = game % 3 == 0 ? FrictionStep() : step;  // or with the guess of another problem
    Coordinates v;
    ASSERT_TRUE(step.solve(problem.a, problem.r, problem.friction, v));
    const Coordinates force = problem.r - problem.a * v;
    for (Eigen::Index i = 0; i < v.rows(); ++i) {
      constexpr double kRounding = 1e-8;
      if (v[i] == 0) {
        ++sticking;
        EXPECT_LE(std::abs(force[i]), problem.friction[i] + kRounding);
      } else {
        EXPECT_NEAR(force[i], std::copysign(problem.friction[i], v[i]), kRounding);
      }
    }
  }
  EXPECT_GT(sticking, 1000) << "hardly anything sticks, so that sticking is not tested";
}

TEST(FrictionStep, WithoutFrictionIsALinearSystem) {
  FrictionStep step;
  const CoordinateMatrix a{{2, 1}, {1, 3}};
  const Coordinates r{{1, 2}};
  Coordinates v;
  ASSERT_TRUE(step.solve(a, r, Coordinates::Zero(2), v));
  EXPECT_NEAR(v[0], 0.2, 1e-15);
  EXPECT_NEAR(v[1], 0.6, 1e-15);
}

TEST(FrictionStep, DoesNotAllocate) {
  FORCEBOUND_SKIP_UNLESS_ALLOCATIONS_COUNT();
  std::mt19937_64 random(2);
  FrictionStep step;
  const Problem problem = drawn(random);
  Coordinates v;
  const test::AllocationGuard guard;
  ASSERT_TRUE(step.solve(problem.a, problem.r, problem.friction, v));
  EXPECT_EQ(guard.heap_operations(), 0U);
}

}  // namespace
}  // namespace forcebound::server
