#pragma once

#include <Eigen/Core>
#include <array>

namespace forcebound::scene {

/// A point, direction or force in the scene's frame. Scenes of one or two dimensions lie on the first axes.
using Point = Eigen::Vector3d;

/// A point in a trivially copyable state.
inline std::array<double, 3> to_array(const Point& point) noexcept { return {point.x(), point.y(), point.z()}; }
inline Point to_point(const std::array<double, 3>& values) noexcept { return Eigen::Map<const Point>(values.data()); }

}  // namespace forcebound::scene
