#pragma once

#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {

/// All that is no further than `radius_m` from the straight between two points: a cylinder with round ends; on two axes
/// a stadium. Its distance is exact inside and outside. On the straight itself the normal is the last one that was
/// valid, turned square to the straight.
std::unique_ptr<Shape> make_capsule(const Point& from_m, const Point& to_m, double radius_m);

}  // namespace forcebound::scene
