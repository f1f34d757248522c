#include "forcebound/control/damping.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "forcebound/control/classic_text.hpp"

namespace forcebound::control {
namespace {

// Credited in every direction where the damping at the tip cannot be computed: above zero, so that it can be divided
// by, and so small that it earns nothing a person could feel.
constexpr double kDampingLeast = 1e-6;
// Keeps the mobility invertible in singular configurations: no direction is credited with more than 1e6 N s/m.
constexpr double kMobilityLeast = 1e-6;

[[noreturn]] void refuse(const Matrix& b, const char* what) {
  ClassicText text;
  text << "damping must be symmetric, positive definite and finite, with 1 to " << kJointsMax << " rows: " << what
       << ", got [" << b.format(Eigen::IOFormat(Eigen::StreamPrecision, Eigen::DontAlignCols, ",", ";")) << "]";
  throw std::invalid_argument(text.str());
}

}  // namespace

Damping Damping::from_matrix(const Matrix& b) {
  if (b.size() == 0) refuse(b, "it has no rows");
  if (b.rows() != b.cols()) refuse(b, "it is not square");
  if (!b.allFinite()) refuse(b, "it is not finite");
  if ((b - b.transpose()).cwiseAbs().maxCoeff() > 1e-12 * b.cwiseAbs().maxCoeff()) refuse(b, "it is not symmetric");
  const Eigen::LLT<Matrix> factor(b);
  if (factor.info() != Eigen::Success || !(factor.matrixLLT().diagonal().minCoeff() > 0)) {
    refuse(b, "it is not positive definite");
  }
  return {b, factor.matrixL()};
}

Damping Damping::of_axis(double b) noexcept {
  return {Matrix::Constant(1, 1, b), Matrix::Constant(1, 1, std::sqrt(b))};
}

Damping Damping::from_joints(const Matrix& jacobian, const Matrix& joint_damping) noexcept {
  const Eigen::Index dof = jacobian.rows();
  const Matrix unit = Matrix::Identity(dof, dof);
  const Eigen::LLT<Matrix> joints(joint_damping);
  if (joints.info() == Eigen::Success && jacobian.allFinite()) {
    const Matrix mobility = jacobian * joints.solve(jacobian.transpose()) + kMobilityLeast * unit;
    const Eigen::LLT<Matrix> tip(mobility);
    if (tip.info() == Eigen::Success) {
      const Matrix solved = tip.solve(unit);
      const Matrix b = 0.5 * (solved + solved.transpose());
      const Eigen::LLT<Matrix> factor(b);
      if (factor.info() == Eigen::Success && b.allFinite()) return {b, factor.matrixL()};
    }
  }
  return {kDampingLeast * unit, std::sqrt(kDampingLeast) * unit};
}

Vector Damping::factor_transpose_times(const Vector& v) const noexcept {
  return factor_.transpose().triangularView<Eigen::Upper>() * v;
}

Vector Damping::factor_solve(const Vector& v) const noexcept { return factor_.triangularView<Eigen::Lower>().solve(v); }

double Damping::dissipation(const Vector& v) const noexcept { return factor_transpose_times(v).squaredNorm(); }

double Damping::mobility(const Vector& f) const noexcept { return factor_solve(f).squaredNorm(); }

Vector diagonal_below(const Matrix& damping) noexcept {
  const Vector diagonal = damping.diagonal();
  if (damping.isDiagonal(0)) return diagonal;
  const Vector scale = diagonal.cwiseSqrt().cwiseInverse();
  // Rows beyond the last have eigenvalue 1, which is never the smallest: those of `scaled` are 1 on average.
  using Largest = Eigen::Matrix<double, kJointsMax, kJointsMax>;
  Largest scaled = Largest::Identity();
  scaled.topLeftCorner(damping.rows(), damping.rows()) = scale.asDiagonal() * damping * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Largest> eigen(scaled, Eigen::EigenvaluesOnly);
  // The smallest eigenvalue is known to rounding of the largest, which is at most the number of rows.
  constexpr double kEigenvalueRounding = 1e-14;
  return std::max(eigen.eigenvalues()[0] - kEigenvalueRounding, std::numeric_limits<double>::min()) * diagonal;
}

}  // namespace forcebound::control
