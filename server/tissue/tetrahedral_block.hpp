#pragma once

#include <array>
#include <cstddef>

#include "forcebound/server/geometry/point.hpp"
#include "forcebound/server/tissue/gmsh_file.hpp"

namespace forcebound::server {

/// A block along the axes.
struct BlockDescription {
  std::array<std::size_t, 3> cells{1, 1, 1};  ///< along each axis, >= 1
  Point from_m = Point::Zero();               ///< its corner of least coordinates
  Point size_m = Point::Zero();               ///< > 0
};

/// A block of cells, each cut into six tetrahedra around its diagonal, so that they fit. Its nodes follow each other
/// along x first, then y, then z.
[[nodiscard]] TetrahedralSoup tetrahedral_block(const BlockDescription& block);

}  // namespace forcebound::server
