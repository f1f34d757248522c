#include "forcebound/server/tissue/rotation.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace forcebound::server {
namespace {

// Below this share of the cube of its size a deformation is too flat for Newton's iteration, which inverts it.
constexpr double kFlat = 0.01;

constexpr int kIterationsMax = 12;
constexpr double kSettled = 1e-14;

Eigen::Matrix3d by_singular_values(const Eigen::Matrix3d& deformation) noexcept {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(deformation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d left = svd.matrixU();
  // The last stretch is the smallest.
  if ((left * svd.matrixV().transpose()).determinant() < 0) left.col(2) = -left.col(2);
  return left * svd.matrixV().transpose();
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

}  // namespace forcebound::server
