#pragma once

#include <string>
#include <vector>

#include "forcebound/scene/geometry/shape.hpp"
#include "forcebound/scene/geometry/triangle_mesh.hpp"

namespace forcebound::scene {

/// A point of a profile that is turned about the z axis.
struct LathePoint {
  double radius_m = 0;
  double height_m = 0;
};

/// The solid of revolution of a closed profile, as a closed mesh of `segments` around: pots, bowls, rings.
///
/// The profile goes anticlockwise around its inside, with the radius to the right and the height up. Where it lies on
/// the axis the triangles meet in a point; edges along the axis have none.
///
/// @throws GeometryError unless the profile has at least 3 points with radius >= 0, and 3 to 4096 segments.
[[nodiscard]] TriangleMesh make_lathe(std::string name, const std::vector<LathePoint>& profile, int segments,
                                      const Point& origin_m = Point::Zero());

/// A mesh of revolution, rendered with a god object.
ShapeKind lathe_shape();

}  // namespace forcebound::scene
