#include "forcebound/tissue/tetrahedral_block.hpp"

#include <algorithm>

namespace forcebound::tissue {

void add_box(TetrahedralSoup& soup, const std::array<std::size_t, 8>& corners) {
  soup.boxes.push_back(corners);
  std::array<std::size_t, 3> axes{0, 1, 2};
  do {
    TetrahedralSoup::Tetrahedron tetrahedron;
    std::size_t corner = 0;
    tetrahedron.nodes[0] = corners[corner];
    for (std::size_t step = 0; step < 3; ++step) {
      corner += std::size_t{1} << axes[step];
      tetrahedron.nodes[step + 1] = corners[corner];
    }
    soup.tetrahedra.push_back(tetrahedron);
  } while (std::next_permutation(axes.begin(), axes.end()));
}

TetrahedralSoup tetrahedral_block(const BlockDescription& block) {
  using Steps = std::array<std::size_t, 3>;
  TetrahedralSoup soup{.name = "block", .nodes = {}, .tetrahedra = {}};
  const std::size_t nx = block.cells[0];
  const std::size_t ny = block.cells[1];
  const std::size_t nz = block.cells[2];
  const auto node = [&](const Steps& at) { return at[0] + (nx + 1) * (at[1] + (ny + 1) * at[2]); };
  const scene::Point counts(static_cast<double>(nx), static_cast<double>(ny), static_cast<double>(nz));
  for (std::size_t z = 0; z <= nz; ++z) {
    for (std::size_t y = 0; y <= ny; ++y) {
      for (std::size_t x = 0; x <= nx; ++x) {
        const scene::Point steps(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
        soup.nodes.emplace_back(block.from_m + block.size_m.cwiseProduct(steps.cwiseQuotient(counts)));
      }
    }
  }
  for (std::size_t cell = 0; cell < nx * ny * nz; ++cell) {
    const Steps corner{cell % nx, cell / nx % ny, cell / nx / ny};
    std::array<std::size_t, 8> box{};
    for (std::size_t k = 0; k < 8; ++k) {
      const auto [x, y, z] = TetrahedralSoup::steps_to(k);
      box[k] = node({corner[0] + x, corner[1] + y, corner[2] + z});
    }
    add_box(soup, box);
  }
  return soup;
}

}  // namespace forcebound::tissue
