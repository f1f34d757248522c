#pragma once

#include "forcebound/control/vector.hpp"

namespace forcebound::control {

/// A positive definite lower bound b of the device's physical damping in task space, with its Cholesky factor.
///
/// Real time: everything but `from_matrix` is noexcept and allocates nothing.
class Damping {
 public:
  /// @param damping_N_s_per_m dof x dof, [N s/m] ([N m s/rad] for rotations).
  /// @throws std::invalid_argument unless it is square, of 1 to 7 rows, finite, symmetric and positive definite.
  static Damping from_matrix(const Matrix& damping_N_s_per_m);

  /// Of one degree of freedom; above zero and finite [N s/m].
  static Damping of_axis(double damping_N_s_per_m) noexcept;

  /// The damping that an arm with joint damping D shows at its tip: b = J^-T D J^-1 with as many joints as axes of the
  /// tip. With more, b = (J D^-1 J')^-1: of all the joint speeds q' that give the tip a velocity v = J q', none
  /// dissipates less than v'b v (q' = D^-1 J'b v dissipates just that).
  ///
  /// Built from the mobility J D^-1 J' + epsilon I, so that it exists at and near singular configurations as well;
  /// there it is smaller than the exact value, hence still a lower bound. Where even that fails (a Jacobian that is
  /// not finite or overflows), it is 1e-6 N s/m in every direction, the smallest damping that is ever credited.
  static Damping from_joints(const Matrix& jacobian, const Matrix& joint_damping) noexcept;

  [[nodiscard]] int degrees_of_freedom() const noexcept { return static_cast<int>(matrix_.rows()); }

  /// b itself [N s/m].
  [[nodiscard]] const Matrix& matrix() const noexcept { return matrix_; }

  /// C' v for the factor b = C C' (C lower triangular).
  [[nodiscard]] Vector factor_transpose_times(const Vector& v) const noexcept;

  /// C^-1 v.
  [[nodiscard]] Vector factor_solve(const Vector& v) const noexcept;

  /// v' b v: power [W] dissipated at velocity v, never negative.
  [[nodiscard]] double dissipation(const Vector& v) const noexcept;

  /// f' b^-1 f [W]: never negative.
  [[nodiscard]] double mobility(const Vector& f) const noexcept;

 private:
  Damping(Matrix matrix, Matrix factor) : matrix_(std::move(matrix)), factor_(std::move(factor)) {}

  Matrix matrix_;
  Matrix factor_;
};

/// The largest multiple of diag(b) that is not above b, as a vector [N s/m]: what an algorithm that treats each axis on
/// its own may credit. Where b is diagonal, b itself.
///
/// lambda_min(S^-1 b S^-1) S^2 with S^2 = diag(b); always above zero.
/// Real time: no allocation, O(dof^3).
[[nodiscard]] Vector diagonal_below(const Matrix& damping) noexcept;

}  // namespace forcebound::control
