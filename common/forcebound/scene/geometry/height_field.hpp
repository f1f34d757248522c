#pragma once

#include <vector>

#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {

/// Heights on a grid of squares along the first two axes; z points up.
struct HeightGrid {
  Point origin_m = Point::Zero();   ///< of the first height, which adds to its z
  double spacing_m = 1;             ///< > 0, between neighbours
  std::size_t columns = 0;          ///< >= 2, along x
  std::vector<double> heights_m{};  ///< at least two rows of so many columns, one row after the other along y
};

/// A relief: everything below the heights is filled, bilinearly between them; beyond the rim nothing is. The rim is an
/// upright cliff, so that no force begins in the midst of the air.
///
/// The surface is as far away as the tangent plane above or below the point, of slopes that go over smoothly from
/// square to square (central differences at the grid's points, bilinear between them):
///
///     normal  n = (-h_x, -h_y, 1) / |...|,    penetration  (h(x, y) - z) n_z
///
/// Exact for planes, of first order in distance times curvature else. The penetration is continuous everywhere, within
/// the smaller of this and the way to the cliff; the normal is but where top and cliff are equally near from within.
std::unique_ptr<Shape> make_height_field(const HeightGrid& grid);

}  // namespace forcebound::scene
