#pragma once

#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {

/// All points within `radius_m` of the segment between two points: a cylinder with round ends; on two axes a stadium.
/// Its distance is exact inside and outside. On the segment itself the normal is the last valid one, turned
/// perpendicular to the segment.
std::unique_ptr<Shape> make_capsule(const Point& from_m, const Point& to_m, double radius_m);

ShapeKind capsule_shape();

}  // namespace forcebound::scene
