#pragma once

#include <cstdint>

#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::scene {

/// Which part of a triangle a point of it belongs to: its inside, the edge from corner i to i + 1, or corner i.
struct TrianglePart {
  enum class Kind : std::uint8_t { face, edge, corner };
  Kind kind = Kind::face;
  std::uint8_t index = 0;
};

struct NearestOnTriangle {
  Point point_m;
  TrianglePart part;
};

/// The point of the triangle abc that is nearest to p, by the region of its plane that p lies over.
///
/// Real time: noexcept, no allocation.
[[nodiscard]] NearestOnTriangle nearest_on_triangle(const Point& p, const Point& a, const Point& b,
                                                    const Point& c) noexcept;

}  // namespace forcebound::scene
