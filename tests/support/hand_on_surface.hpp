#pragma once

#include <string>

#include "forcebound/scene/scene.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::test {

/// Keys of the hand `wave` that bring its middle to a surface of the scene, a comma before each: ",offset_x_m=0.1".
/// @param axes of the device; none where the scene has no parts
inline std::string offset_on_surface(const scene::Scene& scene, Eigen::Index axes) {
  const scene::Point at_m = scene.parts() > 0 ? scene.on_surface_m(0) : scene::Point::Zero();
  std::string keys;
  for (Eigen::Index axis = 0; axis < axes; ++axis) {
    keys += std::string(",offset_") + "xyz"[axis] + "_m=" + text::to_text(at_m[axis]);
  }
  return keys;
}

}  // namespace forcebound::test
