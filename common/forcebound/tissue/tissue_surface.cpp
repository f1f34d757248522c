#include "forcebound/tissue/tissue_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "forcebound/tissue/triangle.hpp"

namespace forcebound::tissue {
namespace {

// Share of a triangle's edges below which two places count as one.
constexpr double kSamePlace = 1e-9;

int corner_of(const TissueSurface::Triangle& triangle, int node) noexcept {
  return static_cast<int>(std::ranges::find(triangle, node) - triangle.begin());
}

double angle_between(const scene::Point& a, const scene::Point& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

}  // namespace

TissueSurface::TissueSurface(std::vector<scene::Point> nodes_m, std::vector<Triangle> triangles)
    : nodes_m_(std::move(nodes_m)), triangles_(std::move(triangles)) {
  find_neighbours();
  find_normals();
  low_m_ = high_m_ = nodes_m_.front();
  for (const scene::Point& node : nodes_m_) {
    low_m_ = low_m_.cwiseMin(node);
    high_m_ = high_m_.cwiseMax(node);
  }
}

void TissueSurface::find_neighbours() {
  beyond_.assign(triangles_.size(), {kNone, kNone, kNone});
  first_triangles_.assign(nodes_m_.size(), kNone);
  struct Side {
    int triangle;
    int corner;
  };
  std::map<std::pair<int, int>, std::vector<Side>> sides;
  for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      int& first = first_triangles_[triangles_[t][corner]];
      if (first == kNone) first = t;
      const int a = triangles_[t][(corner + 1) % 3];
      const int b = triangles_[t][(corner + 2) % 3];
      sides[std::minmax(a, b)].push_back({t, corner});
    }
  }
  for (const auto& [edge, around] : sides) {
    if (around.size() != 2) continue;
    beyond_[around[0].triangle][around[0].corner] = around[1].triangle;
    beyond_[around[1].triangle][around[1].corner] = around[0].triangle;
  }
}

double TissueSurface::longest_edge_m() const noexcept {
  double longest_m = 0;
  for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      longest_m = std::max(longest_m, (corner_m(t, corner) - corner_m(t, (corner + 1) % 3)).norm());
    }
  }
  return longest_m;
}

void TissueSurface::find_normals() {
  node_normals_.assign(nodes_m_.size(), scene::Point::Zero());
  for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const scene::Point& here = corner_m(t, corner);
      const double angle = angle_between(corner_m(t, (corner + 1) % 3) - here, corner_m(t, (corner + 2) % 3) - here);
      node_normals_[triangles_[t][corner]] += angle * triangle_normal(t);
    }
  }
  for (scene::Point& normal : node_normals_) normal.stableNormalize();
}

scene::Point TissueSurface::at(const SurfacePlace& place) const noexcept {
  scene::Point point = scene::Point::Zero();
  for (int corner = 0; corner < 3; ++corner) point += place.weight[corner] * corner_m(place.triangle, corner);
  return point;
}

scene::Point TissueSurface::normal_at(const SurfacePlace& place) const noexcept {
  scene::Point normal = scene::Point::Zero();
  for (int corner = 0; corner < 3; ++corner) {
    normal += place.weight[corner] * node_normals_[triangles_[place.triangle][corner]];
  }
  return normal.stableNormalized();
}

scene::Point TissueSurface::triangle_normal(int triangle) const noexcept {
  const scene::Point& a = corner_m(triangle, 0);
  return (corner_m(triangle, 1) - a).cross(corner_m(triangle, 2) - a).stableNormalized();
}

// The same place by the corners of another triangle, which has all corners that weigh.
SurfacePlace TissueSurface::seen_from(const SurfacePlace& place, int triangle) const noexcept {
  SurfacePlace seen{.triangle = triangle, .weight = scene::Point::Zero()};
  for (int corner = 0; corner < 3; ++corner) {
    if (!(place.weight[corner] > 0)) continue;
    seen.weight[corner_of(triangles_[triangle], triangles_[place.triangle][corner])] = place.weight[corner];
  }
  return seen;
}

// Goes around a node from triangle to triangle, out over the edge opposite to `out`, until it has come round or the
// surface ends.
void TissueSurface::go_around(const SurfacePlace& start, int node, int out, PlacesAround& found) const noexcept {
  int triangle = start.triangle;
  while (found.count < PlacesAround::kMax) {
    const int next = beyond(triangle, out);
    if (next == kNone || next == start.triangle) return;
    // In at this edge, out at the node's other one: its opposite corner is the one that both triangles have.
    const Triangle& here = triangles_[triangle];
    const int shared = 3 - out - corner_of(here, node);
    out = corner_of(triangles_[next], here[shared]);
    triangle = next;
    found.place[found.count++] = seen_from(start, triangle);
  }
}

PlacesAround TissueSurface::places_around(const SurfacePlace& place) const noexcept {
  PlacesAround found;
  found.place[found.count++] = place;
  const auto weighs = (place.weight.array() > 0).count();
  if (weighs == 2) {
    for (int corner = 0; corner < 3; ++corner) {
      const int other = beyond(place.triangle, corner);
      if (place.weight[corner] > 0 || other == kNone) continue;
      found.place[found.count++] = seen_from(place, other);
    }
  } else if (weighs == 1) {
    int corner = 0;
    place.weight.maxCoeff(&corner);
    go_around(place, triangles_[place.triangle][corner], (corner + 1) % 3, found);
  }
  return found;
}

std::optional<SurfacePlace> TissueSurface::entry(const scene::Point& from_m, const scene::Point& to_m) const noexcept {
  const scene::Point way = to_m - from_m;
  std::optional<SurfacePlace> first;
  double first_share = 1;
  for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
    const scene::Point& a = corner_m(t, 0);
    const scene::Point ab = corner_m(t, 1) - a;
    const scene::Point ac = corner_m(t, 2) - a;
    const scene::Point outward = ab.cross(ac);
    const double fall = -way.dot(outward);
    const double height = (from_m - a).dot(outward);
    // A segment that begins on the surface may begin just below it, by rounding.
    if (!(fall > 0) || height < -kSamePlace * outward.norm() * ab.norm() || height > first_share * fall) continue;
    const scene::Point turned = (from_m - a).cross(way);
    const double on_b = ac.dot(turned) / fall;
    const double on_c = -ab.dot(turned) / fall;
    // A little wider than the triangle, so that a segment through an edge hits one of the two.
    if (on_b < -kSamePlace || on_c < -kSamePlace || on_b + on_c > 1 + kSamePlace) continue;
    const scene::Point weight = scene::Point(1 - on_b - on_c, on_b, on_c).cwiseMax(0);
    first = SurfacePlace{.triangle = t, .weight = weight / weight.sum()};
    first_share = height / fall;
  }
  return first;
}

TissueSurface::Nearest TissueSurface::nearest(const scene::Point& point_m) const noexcept {
  Nearest nearest;
  double nearest_m = 0;
  for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
    const SurfacePlace here{.triangle = t,
                            .weight = nearest_weights(corner_m(t, 0), corner_m(t, 1), corner_m(t, 2), point_m)};
    const scene::Point away = point_m - at(here);
    const double distance_m = away.norm();
    const double over_m = away.dot(triangle_normal(t));
    // Of triangles equally near, around a corner, the one that faces the point most decides the side.
    const double same_m = kSamePlace * (corner_m(t, 1) - corner_m(t, 0)).norm();
    const bool nearer = t == 0 || distance_m < nearest_m - same_m;
    const bool as_near = distance_m <= nearest_m + same_m && std::abs(over_m) > std::abs(nearest.height_m);
    if (!nearer && !as_near) continue;
    nearest = {here, over_m};
    nearest_m = distance_m;
  }
  return nearest;
}

}  // namespace forcebound::tissue
