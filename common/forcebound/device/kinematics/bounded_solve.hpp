#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "forcebound/control/vector.hpp"

namespace forcebound::device {

/// adj(A): A^-1 times the determinant, which singular matrices have too.
inline Eigen::Matrix2d adjugate(const Eigen::Matrix2d& a) noexcept {
  Eigen::Matrix2d result;
  result << a(1, 1), -a(0, 1), -a(1, 0), a(0, 0);
  return result;
}
inline Eigen::Matrix3d adjugate(const Eigen::Matrix3d& a) noexcept {
  Eigen::Matrix3d result;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d next = a.row((i + 1) % 3);
    result.col(i) = next.cross(Eigen::Vector3d(a.row((i + 2) % 3)));
  }
  return result;
}

/// A^-1 diag(b) for rows of A no longer than 1; with 0.01 in place of a smaller determinant, so that it is finite where
/// A is singular: no element is above 100 max |b|.
///
/// Real time: noexcept, no allocation.
template <int Rows>
control::Matrix bounded_solve(const Eigen::Matrix<double, Rows, Rows>& a,
                              const Eigen::Matrix<double, Rows, 1>& b) noexcept {
  constexpr double kDeterminantLeast = 0.01;
  const double determinant = a.determinant();
  const double divisor = std::copysign(std::max(std::abs(determinant), kDeterminantLeast), determinant);
  return adjugate(a) * b.asDiagonal() / divisor;
}

}  // namespace forcebound::device
