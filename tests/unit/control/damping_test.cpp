#include "forcebound/control/damping.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

#include "tests/support/law_loop.hpp"
#include "tests/support/published_law_checks.hpp"
#include "tests/support/special_numbers.hpp"

namespace forcebound::control {
namespace {

using test::kNaN;
using test::to_matrix;
using test::to_vector;

std::string refusal_of_damping(const Matrix& b) {
  try {
    (void)Damping::from_matrix(b);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

/// Eigenvalues 1e-6 .. 1e6 in directions that are no axes.
Matrix ill_conditioned() {
  const Eigen::Matrix3d turn =
      Eigen::HouseholderQR<Eigen::Matrix3d>(Eigen::Matrix3d{{1, 2, 3}, {-2, 1, 5}, {4, -1, 2}}).householderQ();
  const Eigen::Matrix3d b = turn * Eigen::Vector3d(1e-6, 1, 1e6).asDiagonal() * turn.transpose();
  return 0.5 * (b + b.transpose());
}

TEST(Damping, KnowsItsMatrixAndItsFactor) {
  const Matrix b = to_matrix({{4, 2}, {2, 10}});  // = C C' with C = [2 0; 1 3]
  const Damping damping = Damping::from_matrix(b);
  EXPECT_EQ(damping.degrees_of_freedom(), 2);
  EXPECT_EQ(damping.matrix(), b);
  EXPECT_TRUE(damping.factor_transpose_times(to_vector({1, 1})).isApprox(to_vector({3, 3}), 1e-15));
  EXPECT_TRUE(damping.factor_solve(to_vector({4, 5})).isApprox(to_vector({2, 1}), 1e-15));
}

TEST(Damping, GivesDissipationAndMobilityInClosedForm) {
  const Damping damping = Damping::from_matrix(to_matrix({{4, 2}, {2, 10}}));
  EXPECT_DOUBLE_EQ(damping.dissipation(to_vector({1, 1})), 18.0);
  EXPECT_DOUBLE_EQ(damping.mobility(to_vector({4, 5})), 5.0);
}

TEST(Damping, DissipatesAndYieldsNeverLessThanNothing) {
  const Damping damping = Damping::from_matrix(ill_conditioned());
  for (const Vector& v : {to_vector({1, -1, 1}), to_vector({1e-300, 1e-300, 0}), to_vector({0, 0, 0})}) {
    EXPECT_GE(damping.dissipation(v), 0.0);
    EXPECT_GE(damping.mobility(v), 0.0);
  }
}

TEST(Damping, AcceptsConditionNumber1e12) {
  const Matrix b = ill_conditioned();
  const Damping damping = Damping::from_matrix(b);
  const Vector v = to_vector({0.3, -0.7, 0.2});
  EXPECT_NEAR(damping.dissipation(v), v.dot(b * v), 1e-12 * b.norm());
}

TEST(Damping, RefusesWhatIsNoPositiveDefiniteMatrix) {
  EXPECT_THAT(refusal_of_damping(Matrix(0, 0)), testing::HasSubstr("it has no rows"));
  EXPECT_THAT(refusal_of_damping(Matrix::Identity(2, 3)), testing::HasSubstr("it is not square"));
  EXPECT_THAT(refusal_of_damping(to_matrix({{kNaN}})), testing::HasSubstr("it is not finite"));
  EXPECT_THAT(refusal_of_damping(to_matrix({{std::numeric_limits<double>::infinity()}})),
              testing::HasSubstr("not finite"));
  EXPECT_THAT(refusal_of_damping(to_matrix({{1, 0.5}, {0.4, 1}})), testing::HasSubstr("it is not symmetric"));
  EXPECT_THAT(refusal_of_damping(to_matrix({{0}})), testing::HasSubstr("it is not positive definite"));
  EXPECT_THAT(refusal_of_damping(to_matrix({{-1}})), testing::HasSubstr("it is not positive definite"));
  EXPECT_THAT(refusal_of_damping(to_matrix({{1, 1}, {1, 1}})), testing::HasSubstr("it is not positive definite"));
}

TEST(Damping, RefusesAMatrixThatRoundingMadeIndefinite) {
  EXPECT_THAT(refusal_of_damping(to_matrix({{1, 1}, {1, 1 - 1e-15}})),
              testing::HasSubstr("it is not positive definite"));
}

TEST(Damping, NamesTheMatrixItRefuses) {
  EXPECT_THAT(refusal_of_damping(to_matrix({{1, 2}, {2, 1}})), testing::HasSubstr("got [1,2;2,1]"));
}

TEST(Damping, OfAnArmIsItsJointDampingSeenAtTheTip) {
  const Matrix jacobian = to_matrix({{0.1, 0.02, 0}, {-0.03, 0.12, 0.01}, {0, 0.02, 0.09}});
  const Matrix joints = to_matrix({{1e-3, 0, 0}, {0, 2e-3, 0}, {0, 0, 5e-4}});
  const Matrix inverse = jacobian.inverse();
  const Matrix exact = inverse.transpose() * joints * inverse;
  const Matrix b = Damping::from_joints(jacobian, joints).matrix();
  EXPECT_TRUE(b.isApprox(exact, 1e-5));
  EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(exact - b).eigenvalues().minCoeff(), -1e-13)
      << "credits more than the joints dissipate";
}

TEST(Damping, OfAnArmWithMoreJointsThanAxesIsTheLeastThatTheJointsCanDissipate) {
  const Matrix jacobian = to_matrix({{0.1, 0.02, 0, 0.05}, {-0.03, 0.12, 0.01, -0.04}});
  const Matrix joints = to_vector({1e-3, 2e-3, 5e-4, 7e-4}).asDiagonal();
  const Damping damping = Damping::from_joints(jacobian, joints);
  EXPECT_EQ(damping.degrees_of_freedom(), 2);
  std::mt19937_64 random(1);
  std::normal_distribution<double> speed;
  for (int trial = 0; trial < 1000; ++trial) {
    const Vector q = to_vector({speed(random), speed(random), speed(random), speed(random)});
    ASSERT_GE(q.dot(joints * q), damping.dissipation(jacobian * q)) << q.transpose();
  }
  // The joint speeds of least dissipation that move the tip like this.
  const Vector tip = to_vector({0.7, -0.4});
  const Matrix mobility = jacobian * joints.inverse() * jacobian.transpose();
  const Vector least = joints.inverse() * jacobian.transpose() * mobility.inverse() * tip;
  EXPECT_NEAR(least.dot(joints * least), damping.dissipation(tip), 1e-4 * damping.dissipation(tip));
}

TEST(Damping, OfAnArmExistsInSingularConfigurations) {
  const Matrix joints = Matrix::Identity(3, 3) * 1e-3;
  for (const double distance : {1e-3, 1e-9, 1e-200, 0.0}) {
    SCOPED_TRACE(distance);
    const Matrix jacobian = to_matrix({{0.1, 0.1, 0}, {0.1, 0.1 + distance, 0}, {0, 0, 0.1}});
    const Damping damping = Damping::from_joints(jacobian, joints);
    EXPECT_TRUE(damping.matrix().allFinite());
    EXPECT_GT(damping.mobility(to_vector({1, 1, 1})), 0.0);
    EXPECT_LE(damping.dissipation(to_vector({1, -1, 0})), 2 * 1.0000001e6);
  }
}

TEST(Damping, OfAnArmIsTheLeastWhereTheConfigurationIsNotFinite) {
  const Matrix jacobian = Matrix::Constant(3, 3, kNaN);
  const Damping damping = Damping::from_joints(jacobian, Matrix::Identity(3, 3));
  EXPECT_EQ(damping.matrix(), Matrix(1e-6 * Matrix::Identity(3, 3)));
  EXPECT_DOUBLE_EQ(damping.dissipation(to_vector({1, 0, 0})), 1e-6);
}

TEST(Damping, OfAnArmIsTheLeastWhereTheConfigurationOverflows) {
  const Damping damping = Damping::from_joints(Matrix::Identity(2, 2) * 1e200, Matrix::Identity(2, 2));
  EXPECT_TRUE(damping.matrix().allFinite());
  EXPECT_LE(damping.dissipation(to_vector({1, 1})), 2 * 1.0000001e-6);
}

TEST(Damping, OfOneAxisIsTheSameAsOfAMatrixOfOne) {
  const Damping axis = Damping::of_axis(30);
  const Damping matrix = Damping::from_matrix(Matrix::Constant(1, 1, 30.0));
  EXPECT_EQ(axis.matrix(), matrix.matrix());
  EXPECT_EQ(axis.dissipation(to_vector({2})), matrix.dissipation(to_vector({2})));
  EXPECT_EQ(axis.mobility(to_vector({2})), matrix.mobility(to_vector({2})));
}

TEST(DiagonalBelow, IsTheMatrixItselfWhereThatIsDiagonal) {
  EXPECT_EQ(diagonal_below(to_matrix({{4, 0}, {0, 1e-6}})), to_vector({4, 1e-6}));
  EXPECT_EQ(diagonal_below(to_matrix({{30}})), to_vector({30}));
}

TEST(DiagonalBelow, TouchesACoupledMatrixFromBelow) {
  for (int degrees_of_freedom = 2; degrees_of_freedom <= kDofMax; ++degrees_of_freedom) {
    const Matrix b = test::full_damping(degrees_of_freedom, 7);
    const Vector below = diagonal_below(b);
    const Eigen::MatrixXd rest = b - Matrix(below.asDiagonal());
    const double least = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(rest).eigenvalues()[0];
    EXPECT_GE(least, 0.0) << degrees_of_freedom;
    EXPECT_LE(least, 1e-12) << degrees_of_freedom;
    EXPECT_TRUE((below.cwiseQuotient(b.diagonal()).array() - below[0] / b(0, 0)).isZero(1e-14));
  }
}

TEST(DiagonalBelow, StaysAboveZeroForAMatrixNextToSingular) {
  const Vector below = diagonal_below(ill_conditioned());
  EXPECT_TRUE((below.array() > 0).all());
  EXPECT_LT(below.maxCoeff(), 1.0);
}

}  // namespace
}  // namespace forcebound::control
