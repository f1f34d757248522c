#pragma once

#include <array>
#include <cstddef>

#include "forcebound/server/dynamics/tissue/tetrahedral_block.hpp"

namespace forcebound::test {

/// A block of cubes of one size.
struct BlockOfCubes {
  std::array<std::size_t, 3> cubes{1, 1, 1};
  double cube_m = 0.01;
  scene::Point from_m = scene::Point::Zero();  ///< the corner of least coordinates

  [[nodiscard]] std::size_t node(const std::array<std::size_t, 3>& at) const {
    return at[0] + (cubes[0] + 1) * (at[1] + (cubes[1] + 1) * at[2]);
  }
};

inline server::TetrahedralSoup tetrahedra_of(const BlockOfCubes& block) {
  const auto& [x, y, z] = block.cubes;
  const scene::Point counts(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
  return server::tetrahedral_block({.cells = block.cubes, .from_m = block.from_m, .size_m = block.cube_m * counts});
}

}  // namespace forcebound::test
