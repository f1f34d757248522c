#include "forcebound/control/diagonal_bound.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "forcebound/control/damping.hpp"
#include "tests/support/law_loop.hpp"
#include "tests/support/published_law_checks.hpp"

namespace forcebound::control {
namespace {

using test::to_matrix;
using test::to_vector;

double least_eigenvalue(const Eigen::MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvalues()[0];
}

TEST(LargestDiagonalBelow, IsTheMatrixItselfWhereThatIsDiagonal) {
  EXPECT_EQ(largest_diagonal_below(to_matrix({{4, 0}, {0, 1e-6}})), to_vector({4, 1e-6}));
}

TEST(LargestDiagonalBelow, LosesNothingOfAJointThatIsNotCoupled) {
  const Vector b = largest_diagonal_below(to_matrix({{3, 0, 0}, {0, 2, 1}, {0, 1, 2}}));
  EXPECT_NEAR(b[0], 3, 1e-6) << "lambda_min would take half of it";
  EXPECT_NEAR(b[1], 1, 1e-6);
  EXPECT_NEAR(b[2], 1, 1e-6);
}

TEST(LargestDiagonalBelow, TouchesTheMatrixFromBelowAndIsWorthMoreThanTheSmallestEigenvalue) {
  for (int degrees_of_freedom = 2; degrees_of_freedom <= kDofMax; ++degrees_of_freedom) {
    const Matrix damping = test::full_damping(degrees_of_freedom, 7);
    const Vector b = largest_diagonal_below(damping);
    const double least = least_eigenvalue(damping - Matrix(b.asDiagonal()));
    EXPECT_GE(least, 0) << degrees_of_freedom;
    EXPECT_LE(least, 1e-6) << degrees_of_freedom;
    EXPECT_GE(b.array().log().sum(), diagonal_below(damping).array().log().sum()) << degrees_of_freedom;
  }
}

TEST(LargestDiagonalBelow, CountsInTheUnitsOfEachJoint) {
  const Matrix damping = test::full_damping(3, 7);
  const Vector units = to_vector({1, 1e3, 1e-4});
  const Vector b = largest_diagonal_below(damping);
  const Vector in_units = largest_diagonal_below(units.asDiagonal() * damping * units.asDiagonal());
  EXPECT_TRUE(in_units.cwiseQuotient(units).cwiseQuotient(units).isApprox(b, 1e-6));
}

}  // namespace
}  // namespace forcebound::control
