#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "forcebound/control/handle.hpp"

namespace forcebound::control {

[[nodiscard]] inline Eigen::Quaterniond quaternion_of(const Handle::Orientation& orientation) noexcept {
  const auto& [w, x, y, z] = orientation;
  return {w, x, y, z};
}

[[nodiscard]] inline Handle::Orientation orientation_of(const Eigen::Quaterniond& quaternion) noexcept {
  return {quaternion.w(), quaternion.x(), quaternion.y(), quaternion.z()};
}

/// The rotation vector [rad], in the frame that both turn into, of the shorter turn that leads from one orientation to
/// another: to = exp(vector) from. Both are unit quaternions. Of half a turn it is one of two.
///
///     q = to from^-1 = (w, v):   2 atan2(|v|, |w|) v/|v|, the sign of w times that        (log of SO(3))
///
/// Real time.
[[nodiscard]] inline Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& from,
                                                     const Eigen::Quaterniond& to) noexcept {
  const Eigen::Quaterniond turn = to * from.conjugate();
  const double sine = turn.vec().norm();
  const double sign = turn.w() < 0 ? -1 : 1;
  // Below this the angle over the sine is 2 to rounding, of any cosine: 1 to rounding.
  constexpr double kSmall = 1e-8;
  const double per_sine = sine > kSmall ? 2 * std::atan2(sine, sign * turn.w()) / sine : 2;
  return sign * per_sine * turn.vec();
}

/// exp(vector): the turn about it by its length [rad]. Real time.
[[nodiscard]] inline Eigen::Quaterniond turn_by(const Eigen::Vector3d& vector) noexcept {
  const double angle = vector.norm();
  constexpr double kSmall = 1e-8;
  const double per_angle = angle > kSmall ? std::sin(0.5 * angle) / angle : 0.5;
  const Eigen::Vector3d part = per_angle * vector;
  return {std::cos(0.5 * angle), part.x(), part.y(), part.z()};
}

/// The shorter turn that leads from one direction to another, neither of length 0; of half a turn one of many.
///
///     q = (1 + a.b, a x b) / sqrt(2 (1 + a.b)), a and b of length 1
///
/// Eigen's FromTwoVectors, but for half a turn without its singular value decomposition, which takes longer to compile
/// than all that most sources do. Real time.
[[nodiscard]] inline Eigen::Quaterniond turn_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) noexcept {
  const Eigen::Vector3d a = from.normalized();
  const Eigen::Vector3d b = to.normalized();
  const double cosine = a.dot(b);
  // Below this a x b is as short as its rounding.
  constexpr double kOpposite = -1 + 1e-12;
  if (cosine < kOpposite) {
    const Eigen::Vector3d other = std::abs(a.y()) < 0.5 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX();
    const Eigen::Vector3d axis = a.cross(other).normalized();
    return {0, axis.x(), axis.y(), axis.z()};
  }
  const double twice = std::sqrt((1 + cosine) * 2);
  const Eigen::Vector3d axis = a.cross(b) * (1 / twice);
  return {twice * 0.5, axis.x(), axis.y(), axis.z()};
}

}  // namespace forcebound::control
