#include "forcebound/tissue/rotation.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <optional>

namespace forcebound::tissue {
namespace {

// Below this share of the cube of its size a deformation is too flat for Newton's iteration, which inverts it.
constexpr double kFlat = 0.01;

constexpr int kIterationsMax = 12;
constexpr double kSettled = 1e-14;

// Newton's method from a near rotation: most turns tried. A turn whose square is below this is the last: the remaining
// error is of the order of its square.
constexpr int kTurnsMax = 5;
constexpr double kLastTurn = 1e-9;

// A stretch whose resistance to rotation has less than this share of the determinant at its size is left to the method
// that always succeeds.
constexpr double kLoose = 1e-3;

Eigen::Matrix3d by_singular_values(const Eigen::Matrix3d& deformation) noexcept {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(deformation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d left = svd.matrixU();
  // The last stretch is the smallest.
  if ((left * svd.matrixV().transpose()).determinant() < 0) left.col(2) = -left.col(2);
  return left * svd.matrixV().transpose();
}

inline Eigen::Matrix3d symmetric(const Eigen::Matrix3d& matrix) noexcept { return 0.5 * (matrix + matrix.transpose()); }

// The further turn, to first order, that makes a deformation, turned back, a pure stretch; nothing where its resistance
// to rotation is not positive definite, or hardly. By cofactors, since most of the time is spent here.
inline std::optional<Eigen::Vector3d> turn_left(const Eigen::Matrix3d& back) noexcept {
  const double xx = back(1, 1) + back(2, 2);
  const double yy = back(2, 2) + back(0, 0);
  const double zz = back(0, 0) + back(1, 1);
  const double xy = -0.5 * (back(0, 1) + back(1, 0));
  const double yz = -0.5 * (back(1, 2) + back(2, 1));
  const double zx = -0.5 * (back(2, 0) + back(0, 2));
  const Eigen::Vector3d of_x(yy * zz - yz * yz, yz * zx - xy * zz, xy * yz - zx * yy);
  const double of_zz = xx * yy - xy * xy;
  const double determinant = xx * of_x.x() + xy * of_x.y() + zx * of_x.z();
  const double size = (xx + yy + zz) / 3;
  if (!(xx > 0 && of_zz > 0 && determinant > kLoose * size * size * size)) return std::nullopt;
  const double of_yz = xy * zx - xx * yz;
  const Eigen::Vector3d twist(back(2, 1) - back(1, 2), back(0, 2) - back(2, 0), back(1, 0) - back(0, 1));
  const Eigen::Vector3d turn(of_x.dot(twist),
                             of_x.y() * twist.x() + (xx * zz - zx * zx) * twist.y() + of_yz * twist.z(),
                             of_x.z() * twist.x() + of_yz * twist.y() + of_zz * twist.z());
  return turn / determinant;
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
  for (int turns = 0; turns <= kTurnsMax; ++turns) {
    const Eigen::Matrix3d back = parts.rotation.toRotationMatrix().transpose() * deformation;
    const auto turn = turn_left(back);
    if (!turn) break;
    if (settled) {
      parts.stretch = symmetric(back);
      return parts;
    }
    const Eigen::Quaterniond by(1, 0.5 * turn->x(), 0.5 * turn->y(), 0.5 * turn->z());
    parts.rotation = (parts.rotation * by).normalized();
    settled = turn->squaredNorm() < kLastTurn;
  }
  const Eigen::Matrix3d rotation = nearest_rotation(deformation);
  return {.rotation = Eigen::Quaterniond(rotation), .stretch = symmetric(rotation.transpose() * deformation)};
}

}  // namespace forcebound::tissue
