#pragma once

#include <vector>

#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {

/// Heights on a grid of squares along the first two axes; z points up.
struct HeightGrid {
  Point origin_m = Point::Zero();   ///< of the first height; its z is added to all heights
  double spacing_m = 1;             ///< > 0, between neighbours
  std::size_t columns = 0;          ///< >= 2, along x
  std::vector<double> heights_m{};  ///< at least two rows of `columns` heights, one row after the other along y
};

/// A relief: everything below the heights is solid, bilinear between the grid's points; outside the grid is free space.
/// The rim is a vertical cliff, so that the force is continuous there.
///
/// The distance to the surface is that to the tangent plane above or below the point, with slopes that are continuous
/// from square to square (central differences at the grid's points, bilinear between them):
///
///     normal  n = (-h_x, -h_y, 1) / |...|,    penetration  (h(x, y) - z) n_z
///
/// Exact for planes, else of first order in distance times curvature. The penetration is continuous everywhere: inside,
/// the smaller of this and the distance to the cliff. The normal is continuous except where top and cliff are equally
/// near from within.
std::unique_ptr<Shape> make_height_field(const HeightGrid& grid);

/// The shape of kind height_field, with heights from the scene or from a file of comma-separated numbers, one row per
/// line. Rows follow each other along y, numbers of a row along x.
ShapeKind height_field_shape();

}  // namespace forcebound::scene
