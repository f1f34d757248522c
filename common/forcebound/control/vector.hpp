#pragma once

#include <Eigen/Core>

namespace forcebound::control {

/// Degrees of freedom of a tip at most.
inline constexpr int kDofMax = 6;
/// Joints of a device or robot at most: an arm may have one more than its tip has degrees of freedom.
inline constexpr int kJointsMax = 7;

/// A position [m], displacement [m], force [N] or their generalized counterparts (rotation vector [rad], torque [N m],
/// joint angle [rad]). The number of rows is the number of degrees of freedom, 1 to 6, or of joints, 1 to 7, and a
/// fact of run time; the storage is inside the object, so none of these ever touches the heap.
using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kJointsMax, 1>;

/// A square or Jacobian matrix over such vectors, likewise without heap.
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kJointsMax, kJointsMax>;

}  // namespace forcebound::control
