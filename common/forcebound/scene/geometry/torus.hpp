#pragma once

#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {

/// A ring: all points within `minor_radius_m` of the circle of `major_radius_m` around an axis (any length but zero).
/// Its distance is exact inside and outside. On the circle itself the normal is the last valid one, turned
/// perpendicular to the circle; on the axis, where the whole circle is equally near, the last valid direction decides
/// the side.
///
/// 0 < minor < major: a ring with a hole.
std::unique_ptr<Shape> make_torus(const Point& center_m, const Point& axis, double major_radius_m,
                                  double minor_radius_m);

ShapeKind torus_shape();

}  // namespace forcebound::scene
