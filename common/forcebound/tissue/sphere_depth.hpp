#pragma once

#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::tissue {

/// Depth of a sphere at a place: that of the paraboloid that touches the sphere at its tip, along a direction.
struct SphereDepth {
  /// @param from_place_m to the sphere's centre
  /// @param direction unit, along which the sphere is held off
  SphereDepth(const scene::Point& from_place_m, const scene::Point& direction, double radius_m) noexcept
      : below_m(-from_place_m.dot(direction)),
        aside_m(from_place_m + below_m * direction),
        depth_m(below_m + radius_m - aside_m.squaredNorm() / (2 * radius_m)) {}

  double below_m;        ///< the centre, along the direction
  scene::Point aside_m;  ///< the centre, across it
  double depth_m;
};

}  // namespace forcebound::tissue
