#include <array>

#include "forcebound/server/environment/mesh_file.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {

void fuzz_mesh(Bytes bytes) {
  static std::array<InputFile, 3> files{InputFile("mesh.obj"), InputFile("mesh.off"), InputFile("mesh.stl")};
  Script script(bytes);
  InputFile& file = files[script.byte() % files.size()];
  file.replace(script.take(bytes.size()));
  may_refuse([&] { (void)server::load_mesh(file.path()); });
}

}  // namespace forcebound::fuzz
