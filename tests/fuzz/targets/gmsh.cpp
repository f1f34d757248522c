#include <sstream>

#include "forcebound/tissue/gmsh_file.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {

void fuzz_gmsh(Bytes bytes) {
  may_refuse([&] {
    std::istringstream text{std::string(text_of(bytes))};
    const tissue::TetrahedralSoup soup = tissue::read_gmsh(text, "mesh.msh");
    must(!soup.tetrahedra.empty(), "a mesh without a tetrahedron");
    for (const auto& tetrahedron : soup.tetrahedra) {
      for (const std::size_t node : tetrahedron.nodes) must(node < soup.nodes.size(), "a node that the mesh lacks");
    }
  });
}

}  // namespace forcebound::fuzz
