#pragma once

#include <rapidcheck.h>

#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::test {

/// Any point of the cube of `half_size` around the origin, its faces and centre among them.
inline scene::Point draw_point(double half_size) {
  constexpr int kParts = 1000;
  const auto draw = [&] { return half_size * *rc::gen::inRange(-kParts, kParts + 1) / kParts; };
  const double x = draw();
  const double y = draw();
  return {x, y, draw()};
}

}  // namespace forcebound::test
