#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace forcebound::tissue {

/// The rotation nearest to a matrix, in the sense of the sum of squares of the difference: the rotational part of a
/// deformation F, R of F = R S. Where F turns space inside out (det F < 0) or is flat, S gets one negative or vanishing
/// stretch, the smallest, so that R always is a rotation and an elastic force always leads back (Irving et al. 2004).
///
/// Real time: noexcept, no allocation, bounded.
[[nodiscard]] Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& deformation) noexcept;

/// A deformation F = R S by its nearest rotation R and its stretch S, symmetric.
struct PolarParts {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d stretch = Eigen::Matrix3d::Identity();
};

/// A stretch's resistance to rotation: turning R by a small w changes |F - R|^2 by w'G w.
///
///     G = tr(S) I - S
///
/// Where G is positive definite, a rotation that makes S symmetric is the nearest one: the sum of squares has no other
/// minimum (its eigenvalues are the sums of two stretches each, and only the smallest may be negative).
[[nodiscard]] inline Eigen::Matrix3d hold_on_rotation(const Eigen::Matrix3d& stretch) noexcept {
  Eigen::Matrix3d hold = -stretch;
  hold.diagonal().array() += stretch.trace();
  return hold;
}

/// Both parts, by Newton's method from a rotation `near`, which takes two turns where R has changed little; where that
/// does not lead to it, by nearest_rotation. The result depends on `near` by rounding alone.
///
/// Real time: noexcept, no allocation, bounded.
[[nodiscard]] PolarParts polar_parts(const Eigen::Matrix3d& deformation, const Eigen::Quaterniond& near) noexcept;

}  // namespace forcebound::tissue
