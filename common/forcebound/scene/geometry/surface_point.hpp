#pragma once

#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::scene {

/// Depth and normal of a point relative to a surface.
struct SurfacePoint {
  Point normal = Point::UnitX();  ///< unit, out of the surface where it is nearest
  double penetration_m = 0;       ///< > 0: depth inside the solid; < 0: no contact, minus the distance outside
  bool normal_is_old = false;     ///< `normal` is the last valid one: no direction is nearest, as at a sphere's centre
};

}  // namespace forcebound::scene
