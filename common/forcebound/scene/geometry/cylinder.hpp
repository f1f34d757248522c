#pragma once

#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {

/// A cylinder with flat ends around the segment between two points; on two axes a rectangle. Its distance is exact
/// inside and outside, edges included. Where the side and an end are equally near from within, the side counts; of the
/// two ends, that at `to_m`. On the axis, where the side is nearest, the normal is the last valid one of the side.
std::unique_ptr<Shape> make_cylinder(const Point& from_m, const Point& to_m, double radius_m);

ShapeKind cylinder_shape();

}  // namespace forcebound::scene
