#include "forcebound/server/environment/scene_parser.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {

void fuzz_scene(Bytes bytes) {
  // A file that scenes can name.
  static InputFile file("mesh.obj");
  constexpr std::string_view kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
  file.replace(std::as_bytes(std::span(kTetrahedron)));
  may_refuse([&] { (void)server::parse_scene(text_of(bytes), file.folder() + "/scene.toml"); });
}

}  // namespace forcebound::fuzz
