#include "forcebound/server/tissue/rotation.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace forcebound::server {
namespace {

// Below this share of the cube of its size a deformation is too flat for Newton's iteration, which inverts it.
constexpr double kFlat = 0.01;

constexpr int kIterationsMax = 12;
constexpr double kSettled = 1e-14;

// From nearby: turns are tried so many times, and one as small as that (its square) leaves an error of rounding.
constexpr int kTurnsMax = 5;
constexpr double kLastTurn = 1e-13;

// A stretch whose hold on its rotation has less than this share of the determinant at its size is left to the method
// that always succeeds.
constexpr double kLoose = 1e-3;

Eigen::Matrix3d by_singular_values(const Eigen::Matrix3d& deformation) noexcept {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(deformation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d left = svd.matrixU();
  // The last stretch is the smallest.
  if ((left * svd.matrixV().transpose()).determinant() < 0) left.col(2) = -left.col(2);
  return left * svd.matrixV().transpose();
}

// Twice the axis of the skew part.
Eigen::Vector3d twist(const Eigen::Matrix3d& matrix) noexcept {
  return {matrix(2, 1) - matrix(1, 2), matrix(0, 2) - matrix(2, 0), matrix(1, 0) - matrix(0, 1)};
}

Eigen::Matrix3d symmetric(const Eigen::Matrix3d& matrix) noexcept { return 0.5 * (matrix + matrix.transpose()); }

bool holds_firmly(const Eigen::Matrix3d& hold) noexcept {
  const double size = hold.trace() / 3;
  const double minor = hold(0, 0) * hold(1, 1) - hold(0, 1) * hold(0, 1);
  return hold(0, 0) > 0 && minor > 0 && hold.determinant() > kLoose * size * size * size;
}

}  // namespace

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& deformation) noexcept {
  const double size = deformation.norm() / std::sqrt(3.0);
  if (!(deformation.determinant() > kFlat * size * size * size)) return by_singular_values(deformation);
  // Newton's iteration towards X'X = I (Higham 1986), quadratic from here on.
  Eigen::Matrix3d rotation = deformation / size;
  for (int iteration = 0; iteration < kIterationsMax; ++iteration) {
    Eigen::Matrix3d inverse_transposed;
    inverse_transposed.col(0) = rotation.col(1).cross(rotation.col(2));
    inverse_transposed.col(1) = rotation.col(2).cross(rotation.col(0));
    inverse_transposed.col(2) = rotation.col(0).cross(rotation.col(1));
    inverse_transposed /= rotation.col(0).dot(inverse_transposed.col(0));
    const Eigen::Matrix3d next = 0.5 * (rotation + inverse_transposed);
    const double change = (next - rotation).squaredNorm();
    rotation = next;
    if (change < kSettled) return rotation;
  }
  return rotation;
}

PolarParts polar_parts(const Eigen::Matrix3d& deformation, const Eigen::Quaterniond& near) noexcept {
  PolarParts parts{.rotation = near};
  bool settled = false;
  for (int turns = 0;; ++turns) {
    const Eigen::Matrix3d turned_back = parts.rotation.toRotationMatrix().transpose() * deformation;
    parts.stretch = symmetric(turned_back);
    const Eigen::Matrix3d hold = hold_on_rotation(parts.stretch);
    if (!holds_firmly(hold) || turns == kTurnsMax) break;
    if (settled) return parts;
    const Eigen::Vector3d turn = hold.inverse() * twist(turned_back);
    const Eigen::Quaterniond by(1, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z());
    parts.rotation = (parts.rotation * by).normalized();
    settled = turn.squaredNorm() < kLastTurn;
  }
  const Eigen::Matrix3d rotation = nearest_rotation(deformation);
  return {.rotation = Eigen::Quaterniond(rotation), .stretch = symmetric(rotation.transpose() * deformation)};
}

}  // namespace forcebound::server
