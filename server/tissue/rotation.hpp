#pragma once

#include <Eigen/Core>

namespace forcebound::server {

/// The rotation nearest to a matrix, in the sense of the sum of squares of the difference: the rotational part of a
/// deformation F, R of F = R S. Where F turns space inside out (det F < 0) or is flat, S gets one negative or vanishing
/// stretch, the smallest, so that R always is a rotation and an elastic force always leads back (Irving et al. 2004).
///
/// Real time: noexcept, no allocation, bounded.
[[nodiscard]] Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& deformation) noexcept;

}  // namespace forcebound::server
