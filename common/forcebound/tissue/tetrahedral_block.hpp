#pragma once

#include <array>
#include <cstddef>

#include "forcebound/scene/geometry/point.hpp"
#include "forcebound/tissue/gmsh_file.hpp"

namespace forcebound::tissue {

/// A block along the axes.
struct BlockDescription {
  std::array<std::size_t, 3> cells{1, 1, 1};   ///< along each axis, >= 1
  scene::Point from_m = scene::Point::Zero();  ///< its corner of least coordinates
  scene::Point size_m = scene::Point::Zero();  ///< > 0
};

/// Adds a box of those corners, and its six tetrahedra.
void add_box(TetrahedralSoup& soup, const std::array<std::size_t, 8>& corners);

/// A block of boxes, each cut into six tetrahedra around its diagonal, so that they fit. Its nodes follow each other
/// along x first, then y, then z.
[[nodiscard]] TetrahedralSoup tetrahedral_block(const BlockDescription& block);

}  // namespace forcebound::tissue
