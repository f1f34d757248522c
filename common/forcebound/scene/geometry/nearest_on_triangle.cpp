#include "forcebound/scene/geometry/nearest_on_triangle.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>

namespace forcebound::scene {
namespace {

using Kind = TrianglePart::Kind;

NearestOnTriangle nearest_on_edge(const Point& p, const Point& from, const Point& to, std::uint8_t edge) noexcept {
  const Point along = to - from;
  const double share = along.dot(p - from) / along.squaredNorm();
  if (!(share > 0)) return {from, {Kind::corner, edge}};
  if (share >= 1) return {to, {Kind::corner, static_cast<std::uint8_t>((edge + 1) % 3)}};
  // From the nearer end, whose rounding error is the smaller one.
  return {share < 0.5 ? Point(from + share * along) : Point(to - (1 - share) * along), {Kind::edge, edge}};
}

}  // namespace

NearestOnTriangle nearest_on_triangle(const Point& p, const Point& a, const Point& b, const Point& c) noexcept {
  const std::array<const Point*, 3> corners{&a, &b, &c};
  const Point normal = (b - a).cross(c - a);
  NearestOnTriangle best;
  double best_squared = std::numeric_limits<double>::infinity();
  for (std::uint8_t edge = 0; edge < 3; ++edge) {
    const Point& from = *corners[edge];
    const Point& to = *corners[(edge + 1U) % 3];
    if ((to - from).cross(p - from).dot(normal) >= 0) continue;  // not beyond this edge
    const NearestOnTriangle found = nearest_on_edge(p, from, to, edge);
    const double squared = (p - found.point_m).squaredNorm();
    if (squared < best_squared) {
      best_squared = squared;
      best = found;
    }
  }
  if (best_squared < std::numeric_limits<double>::infinity()) return best;
  return {p - normal * (normal.dot(p - a) / normal.squaredNorm()), {}};
}

}  // namespace forcebound::scene
