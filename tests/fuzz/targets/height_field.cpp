#include "forcebound/scene/geometry/height_field.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {

void fuzz_height_field(Bytes bytes) {
  static InputFile file("heights.csv");
  static const scene::ShapeKind kKind = scene::height_field_shape();
  file.replace(bytes);
  may_refuse([&] {
    const config::Values given{
        {"origin_m", Eigen::Vector3d(0, 0, 0)}, {"file", std::string("heights.csv")}, {"spacing_m", 0.01}};
    (void)kKind.make(config::completed(kKind.parameters, given), {.folder = file.folder()});
  });
}

}  // namespace forcebound::fuzz
