#include "forcebound/scene/geometry/facets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "forcebound/scene/geometry/internal/skins.hpp"

namespace forcebound::scene {
namespace {

// Largest error of a computed normal: that of the thinnest triangle.
constexpr double kLevel = 0x1p-15;

}  // namespace

Facets::Facets(Bvh tree, bool two_sided)
    : bvh_(std::move(tree)),
      skin_m_(kSkin * bvh_.mesh().size_m()),
      clearance_m_(two_sided ? kClearanceSkins * skin_m_ : 0),
      two_sided_(two_sided) {
  facets_.reserve(bvh_.order().size());
  for (const std::uint32_t triangle : bvh_.order()) facets_.push_back(facet_of(triangle));
}

Facets::Facet Facets::facet_of(std::uint32_t triangle) const {
  const TriangleMesh& mesh = bvh_.mesh();
  const Point& normal = mesh.normals()[triangle];
  const Point middle = (mesh.corner_m(triangle, 0) + mesh.corner_m(triangle, 1) + mesh.corner_m(triangle, 2)) / 3;
  return {{normal, normal.dot(middle)}, {edge_of(triangle, 0), edge_of(triangle, 1), edge_of(triangle, 2)}};
}

Facets::Edge Facets::edge_of(std::uint32_t triangle, std::size_t side) const {
  const TriangleMesh& mesh = bvh_.mesh();
  const Point& normal = mesh.normals()[triangle];
  const Point& from = mesh.corner_m(triangle, side);
  const Point& to = mesh.corner_m(triangle, (side + 1) % 3);
  const Point out = (to - from).cross(normal).normalized();
  const Plane plane{out, 0.5 * out.dot(from + to)};
  const std::uint32_t beyond = mesh.neighbours()[triangle][side];
  if (beyond == TriangleMesh::kNone) return {plane, kEdgeSkins * skin_m_, kOpenBelowSkins * skin_m_};
  const Triangle& own = mesh.triangles()[triangle];
  double rise_m = 0;
  double reach_m = 0;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    if (std::ranges::find(own, mesh.triangles()[beyond][corner]) != own.end()) continue;
    const Point arm = mesh.corner_m(beyond, corner) - from;
    rise_m = normal.dot(arm);
    reach_m = arm.cross(to - from).norm() / (to - from).norm();
  }
  // Seen from behind, a falling surface rises.
  const bool rises = (two_sided_ ? std::abs(rise_m) : rise_m) > kLevel * reach_m;
  if (!rises) return {plane, kEdgeSkins * skin_m_, skin_m_};
  return {plane, (two_sided_ ? kEdgeSkins : kRisingEdgeSkins) * skin_m_, kRisingBelowSkins * skin_m_};
}

bool Facets::is_within(const Facet& facet, const Point& p, double beyond_m) noexcept {
  return std::ranges::all_of(
      facet.edges, [&](const Edge& edge) { return edge.plane.normal.dot(p) - edge.plane.offset <= beyond_m; });
}

Facets::Constraint Facets::seen_from(const Point& p, const Constraint& plane) const noexcept {
  const double side = plane.normal.dot(plane.facet->plane.normal) < 0 ? -1 : 1;
  return {plane.normal, plane.normal.dot(p) - side * plane.facet->plane.offset - clearance_m_, plane.facet};
}

bool Facets::Passage::enter_over(const Facet& facet, const Segment& path) noexcept {
  for (const Edge& edge : facet.edges) {
    const double beyond_m = edge.plane.normal.dot(path.from_m) - edge.plane.offset - edge.beyond_m;
    const double beyond_rate_m = edge.plane.normal.dot(path.way_m);
    if (beyond_rate_m > 0) {
      const double passed = -beyond_m / beyond_rate_m;
      if (passed >= leave) continue;
      leave = passed;
      below_m = edge.below_m;
    } else if (beyond_rate_m < 0) {
      enter = std::max(enter, -beyond_m / beyond_rate_m);
    } else if (beyond_m > 0) {
      return false;
    }
  }
  return enter <= leave;
}

bool Facets::is_in_the_way(const Facet& facet, const Segment& path, double until, Obstacle& found) const noexcept {
  double height_m = facet.plane.normal.dot(path.from_m) - facet.plane.offset;
  const double side = two_sided_ && height_m < 0 ? -1 : 1;
  const double rate_m = side * facet.plane.normal.dot(path.way_m);
  height_m = side * height_m - clearance_m_;
  const double lowest_m = -std::max(kBehindSkins * skin_m_, clearance_m_);
  if (!(rate_m < 0) || height_m < lowest_m || height_m + until * rate_m >= -kRisingBelowSkins * skin_m_) return false;
  Passage over{.leave = until, .below_m = skin_m_};
  if (!over.enter_over(facet, path) || height_m + over.enter * rate_m < lowest_m) return false;
  if (height_m + over.leave * rate_m >= -over.below_m) return false;
  // This close to the plane, rounding decides where a flat path meets it; take the start.
  const double meets = height_m > kOnSkins * skin_m_ ? height_m / -rate_m : 0;
  over.enter = std::max(over.enter, meets);
  if (two_sided_ && is_past_a_corner(facet, path, over)) return false;
  found = {{side * facet.plane.normal, height_m, &facet}, over.enter};
  return true;
}

bool Facets::is_past_a_corner(const Facet& facet, const Segment& path, const Passage& over) const noexcept {
  std::array<std::uint8_t, 2> corners{};
  for (const bool leaves : {false, true}) {
    Point at = path.from_m + (leaves ? over.leave : over.enter) * path.way_m;
    at -= facet.plane.normal * (facet.plane.normal.dot(at) - facet.plane.offset);
    const NearestOnTriangle nearest = bvh_.nearest_on(triangle_of(facet), at);
    if (nearest.part.kind != TrianglePart::Kind::corner) return false;
    if ((nearest.point_m - at).norm() <= kCornerSkins * skin_m_) return false;
    corners[leaves ? 1 : 0] = nearest.part.index;
  }
  return corners[0] == corners[1];
}

bool Facets::changes_sides(const Facet& facet, const Segment& path, double until) const noexcept {
  if (!two_sided_) return false;
  const double height_m = facet.plane.normal.dot(path.from_m) - facet.plane.offset;
  const double rate_m = facet.plane.normal.dot(path.way_m);
  if ((height_m > 0) == (height_m + until * rate_m > 0)) return false;
  Passage over{.leave = until};
  if (!over.enter_over(facet, path)) return false;
  return (height_m + over.enter * rate_m > 0) != (height_m + over.leave * rate_m > 0);
}

}  // namespace forcebound::scene
