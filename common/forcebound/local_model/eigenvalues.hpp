#pragma once

#include <Eigen/Core>

namespace forcebound::local_model {

/// Of a symmetric matrix, the least first. Not Eigen's solver itself, which each source would compile anew, for
/// seconds. Real time.
[[nodiscard]] Eigen::Vector3d eigenvalues(const Eigen::Matrix3d& symmetric) noexcept;

}  // namespace forcebound::local_model
