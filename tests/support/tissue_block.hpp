#pragma once

#include <array>
#include <cstddef>

#include "forcebound/tissue/elasticity.hpp"
#include "forcebound/tissue/tetrahedral_block.hpp"

namespace forcebound::test {

inline constexpr tissue::ElasticMaterial kSoft{.young_Pa = 5000, .poisson = 0.4};

/// A block of cubes of one size.
struct BlockOfCubes {
  std::array<std::size_t, 3> cubes{1, 1, 1};
  double cube_m = 0.01;
  scene::Point from_m = scene::Point::Zero();  ///< the corner of least coordinates

  [[nodiscard]] std::size_t node(const std::array<std::size_t, 3>& at) const {
    return at[0] + (cubes[0] + 1) * (at[1] + (cubes[1] + 1) * at[2]);
  }
};

/// On a bed at z = 0.
inline const BlockOfCubes kThinBlock{.cubes = {4, 4, 2}, .cube_m = 0.01};
inline const BlockOfCubes kThickBlock{.cubes = {6, 6, 3}, .cube_m = 0.01};
inline constexpr double kThinTop_m = 0.02;
inline constexpr double kThickTop_m = 0.03;

inline tissue::TetrahedralSoup tetrahedra_of(const BlockOfCubes& block) {
  const auto& [x, y, z] = block.cubes;
  const scene::Point counts(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
  return tissue::tetrahedral_block({.cells = block.cubes, .from_m = block.from_m, .size_m = block.cube_m * counts});
}

}  // namespace forcebound::test
