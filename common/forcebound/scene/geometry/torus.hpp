#pragma once

#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {

/// A ring: all that is no further than `minor_radius_m` from the circle of `major_radius_m` around an axis (any length
/// but zero). Its distance is exact inside and outside. On the circle itself the normal is the last one that was valid,
/// turned square to the circle; on the axis, where the whole circle is equally near, a side of the last one counts.
///
/// 0 < minor < major: a ring with a hole.
std::unique_ptr<Shape> make_torus(const Point& center_m, const Point& axis, double major_radius_m,
                                  double minor_radius_m);

}  // namespace forcebound::scene
