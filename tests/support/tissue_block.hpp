#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "forcebound/server/tissue/gmsh_file.hpp"

namespace forcebound::test {

/// A block of cubes of one size along the axes, each cut into six tetrahedra around its diagonal, so that they fit.
struct BlockOfCubes {
  std::array<std::size_t, 3> cubes{1, 1, 1};
  double cube_m = 0.01;
  server::Point from_m = server::Point::Zero();  ///< the corner of least coordinates

  [[nodiscard]] std::size_t node(const std::array<std::size_t, 3>& at) const {
    return at[0] + (cubes[0] + 1) * (at[1] + (cubes[1] + 1) * at[2]);
  }
};

inline server::TetrahedralSoup tetrahedra_of(const BlockOfCubes& block) {
  server::TetrahedralSoup soup{.name = "block", .nodes = {}, .tetrahedra = {}};
  const auto& [nx, ny, nz] = block.cubes;
  for (std::size_t z = 0; z <= nz; ++z) {
    for (std::size_t y = 0; y <= ny; ++y) {
      for (std::size_t x = 0; x <= nx; ++x) {
        const server::Point steps(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
        soup.nodes.emplace_back(block.from_m + block.cube_m * steps);
      }
    }
  }
  for (std::size_t cube = 0; cube < nx * ny * nz; ++cube) {
    const std::array<std::size_t, 3> corner{cube % nx, cube / nx % ny, cube / nx / ny};
    std::array<std::size_t, 3> axes{0, 1, 2};
    do {
      auto at = corner;
      server::TetrahedralSoup::Tetrahedron tetrahedron;
      tetrahedron.nodes[0] = block.node(at);
      for (std::size_t step = 0; step < 3; ++step) {
        ++at[axes[step]];
        tetrahedron.nodes[step + 1] = block.node(at);
      }
      soup.tetrahedra.push_back(tetrahedron);
    } while (std::next_permutation(axes.begin(), axes.end()));
  }
  return soup;
}

}  // namespace forcebound::test
