#pragma once

#include <array>
#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::tissue {

/// Tetrahedra as in a file, with unchecked shapes.
struct TetrahedralSoup {
  struct Tetrahedron {
    std::array<std::size_t, 4> nodes{};  ///< indices into `nodes`
    std::size_t line = 0;                ///< of the file, from 1; 0 where there is no file
  };

  std::string name;                 ///< of the file, for messages
  std::vector<scene::Point> nodes;  ///< in the file's unit
  std::vector<Tetrahedron> tetrahedra;

  /// Boxes that the tetrahedra are parts of, six of each; none in a file. Corner k lies at the far end of the box's
  /// edges whose bits k has, the first axis having bit 0.
  std::vector<std::array<std::size_t, 8>> boxes{};

  /// 0 or 1 along each axis: on which edges a box's first corner leads to that one.
  [[nodiscard]] static constexpr std::array<int, 3> steps_to(std::size_t corner) noexcept {
    return {static_cast<int>(corner % 2), static_cast<int>(corner / 2 % 2), static_cast<int>(corner / 4)};
  }
};

/// Reads the linear tetrahedra (element type 4) of a Gmsh mesh: ASCII of version 1, 2 or 4.1. Other elements (points,
/// lines, triangles of the boundary) and sections are skipped.
///
/// @param name of the file, for messages.
/// @throws std::runtime_error `FILE:LINE: what is wrong and what would be accepted`, for anything that the format's
/// description does not allow, for binary files, other versions, and meshes without a tetrahedron.
[[nodiscard]] TetrahedralSoup read_gmsh(std::istream& text, const std::string& name);

/// The same from a file. @throws std::runtime_error also where it cannot be read.
[[nodiscard]] TetrahedralSoup load_gmsh(const std::string& path);

}  // namespace forcebound::tissue
