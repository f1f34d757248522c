#include "forcebound/scene/geometry/triangle_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "forcebound/text/numbers.hpp"
#include "forcebound/text/terminal.hpp"

namespace forcebound::scene {
namespace {

/// One side of a triangle; an edge of two triangles has two sides with the same ends.
struct Side {
  std::uint32_t low;  // the ends in order of their numbers, not of the triangle
  std::uint32_t high;
  std::uint32_t triangle;
  std::uint32_t side;
  bool rising;  // from low to high, seen along the triangle

  bool operator<(const Side& other) const noexcept {
    return std::tie(low, high, triangle, side) < std::tie(other.low, other.high, other.triangle, other.side);
  }
  [[nodiscard]] bool same_edge(const Side& other) const noexcept { return low == other.low && high == other.high; }
};

std::vector<Side> sides_of(const std::vector<Triangle>& triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    for (std::uint32_t side = 0; side < 3; ++side) {
      const auto from = triangles[i][side];
      const auto to = triangles[i][(side + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), i, side, from < to});
    }
  }
  std::ranges::sort(sides, std::less<>{});
  return sides;
}

/// Calls `visit` with the sides of each edge, as two iterators.
template <class Visit>
void for_each_edge(const std::vector<Side>& sides, Visit visit) {
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::find_if(first, sides.end(), [&](const Side& side) { return !side.same_edge(*first); });
    visit(first, last);
    first = last;
  }
}

/// The same triangle, beginning with its lowest corner.
Triangle rotated(Triangle triangle) {
  std::rotate(triangle.begin(), std::ranges::min_element(triangle), triangle.end());
  return triangle;
}

bool repeats_a_corner(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

}  // namespace

std::string to_text(const MeshReport& report) {
  std::string words =
      text::counted(report.triangles, "triangle") + ", " + text::counted(report.vertices, "vertex", "vertices") + ", ";
  words += report.closed() ? (report.volume_m3 < 0 ? "closed, inside out" : "closed") : "open";
  const auto add = [&](std::size_t count, const char* one, const char* many, const char* more = "") {
    if (count > 0) words += "; " + text::counted(count, one, many) + more;
  };
  add(report.open_edges, "open edge", "open edges");
  add(report.non_manifold_edges, "edge", "edges", " of more than two triangles");
  add(report.inconsistent_edges, "edge", "edges", " whose triangles disagree about the outside");
  add(report.welded_vertices, "duplicate vertex", "duplicate vertices", " welded");
  add(report.unreferenced_vertices, "unreferenced vertex", "unreferenced vertices", " dropped");
  add(report.slivers, "sliver", "slivers", " dropped");
  add(report.duplicate_triangles, "duplicate triangle", "duplicate triangles", " dropped");
  return words;
}

TriangleMesh::TriangleMesh(std::string name, const std::vector<Point>& vertices, const std::vector<Triangle>& triangles,
                           const MeshPlacement& placement)
    : name_(std::move(name)), triangles_(triangles) {
  place(vertices, placement);
  mend();
}

TriangleMesh::TriangleMesh(std::string name, const std::vector<Point>& vertices_m,
                           const std::vector<Triangle>& triangles, const MeshFrame& frame)
    : name_(std::move(name)),
      origin_m_(frame.origin_m),
      size_m_(frame.box_m.isEmpty() ? 0 : 0.5 * frame.box_m.sizes().stableNorm()),
      box_m_(frame.box_m),
      vertices_m_(vertices_m),
      triangles_(triangles) {
  check_corners(vertices_m_);
  check_size();
  for (const Triangle& triangle : triangles_) {
    for (const std::uint32_t corner : triangle) {
      if (!box_m_.contains(vertices_m_[corner])) throw GeometryError(name_ + ": a corner lies outside of the box");
    }
  }
  mend();
  report_ = frame.report;
}

void TriangleMesh::mend() {
  weld();
  drop_duplicates();
  count_edges();
  drop_slivers();
  if (triangles_.empty()) {
    throw GeometryError(name_ + ": no triangles, but for " + std::to_string(report_.slivers) + " without an area");
  }
  drop_unreferenced();
  find_normals();
  report_.triangles = triangles_.size();
  report_.vertices = vertices_m_.size();
}

void TriangleMesh::place(const std::vector<Point>& as_read, const MeshPlacement& placement) {
  if (!placement.valid()) {
    throw GeometryError(name_ + ": scale must be > 0, rotation and offset finite, got " +
                        text::to_text(placement.scale));
  }
  std::vector<Point> turned;
  if (placement.turns()) {
    turned.reserve(as_read.size());
    for (const Point& vertex : as_read) turned.emplace_back(placement.rotation * vertex);
  }
  const std::vector<Point>& vertices = placement.turns() ? turned : as_read;
  check_corners(vertices);
  Bounds box;
  for (const Triangle& triangle : triangles_) {
    for (const std::uint32_t corner : triangle) box.extend(vertices[corner]);
  }
  if (box.isEmpty()) throw GeometryError(name_ + ": no triangles");
  // Halves, since the sum of two finite numbers may not be one.
  const Point middle = 0.5 * box.min() + 0.5 * box.max();
  origin_m_ = placement.scale * middle + placement.offset_m;
  vertices_m_.reserve(vertices.size());
  for (const Point& vertex : vertices) {
    vertices_m_.emplace_back(placement.scale * (vertex - middle));
  }
  box_m_ = Bounds(Point(placement.scale * (box.min() - middle)), Point(placement.scale * (box.max() - middle)));
  size_m_ = 0.5 * box_m_.sizes().stableNorm();
  check_size();
}

void TriangleMesh::check_corners(const std::vector<Point>& vertices) const {
  if (vertices.size() >= kNone || triangles_.size() >= kNone / 3) throw GeometryError(name_ + ": too many triangles");
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    for (const std::uint32_t corner : triangles_[i]) {
      if (corner < vertices.size()) continue;
      throw GeometryError(name_ + ": triangle " + std::to_string(i) + " has vertex " + std::to_string(corner) +
                          ", but there are " + std::to_string(vertices.size()));
    }
  }
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (vertices[i].allFinite()) continue;
    throw GeometryError(name_ + ": vertex " + std::to_string(i) + " is not finite");
  }
}

void TriangleMesh::check_size() const {
  // Areas are squares and distances between planes fourth powers of lengths.
  if (!(size_m_ > 1e-60 && size_m_ < 1e60 && origin_m_.allFinite())) {
    throw GeometryError(name_ + ": a size of " + text::rounded(size_m_) + " m cannot be computed with");
  }
}

void TriangleMesh::weld() {
  const auto key = [&](std::uint32_t i) {
    const Point& v = vertices_m_[i];
    return std::make_tuple(v.x(), v.y(), v.z());
  };
  std::vector<std::uint32_t> order(vertices_m_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order,
                    [&](std::uint32_t a, std::uint32_t b) { return std::pair(key(a), a) < std::pair(key(b), b); });
  std::vector<std::uint32_t> kept(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool welded = i > 0 && key(order[i]) == key(order[i - 1]);
    kept[order[i]] = welded ? kept[order[i - 1]] : order[i];
    report_.welded_vertices += welded ? 1 : 0;
  }
  for (Triangle& triangle : triangles_) {
    for (std::uint32_t& corner : triangle) corner = kept[corner];
  }
  report_.slivers += std::erase_if(triangles_, repeats_a_corner);
}

void TriangleMesh::drop_duplicates() {
  std::vector<std::uint32_t> order(triangles_.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t i) { return rotated(triangles_[i]); };
  std::ranges::sort(order,
                    [&](std::uint32_t a, std::uint32_t b) { return std::pair(key(a), a) < std::pair(key(b), b); });
  std::vector<bool> dropped(triangles_.size());
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (key(order[i]) == key(order[i - 1])) dropped[order[i]] = true;
  }
  std::vector<Triangle> kept;
  kept.reserve(triangles_.size());
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    if (!dropped[i]) kept.push_back(triangles_[i]);
  }
  report_.duplicate_triangles = triangles_.size() - kept.size();
  triangles_ = std::move(kept);
}

void TriangleMesh::count_edges() {
  for_each_edge(sides_of(triangles_), [&](auto first, auto last) {
    const auto triangles = std::distance(first, last);
    if (triangles == 1) ++report_.open_edges;
    if (triangles > 2) ++report_.non_manifold_edges;
    if (triangles == 2 && first->rising == std::next(first)->rising) ++report_.inconsistent_edges;
  });
  for (const Triangle& t : triangles_) {
    report_.volume_m3 += vertices_m_[t[0]].dot(vertices_m_[t[1]].cross(vertices_m_[t[2]])) / 6;
  }
  if (!report_.closed()) report_.volume_m3 = 0;
}

void TriangleMesh::drop_slivers() {
  report_.slivers += std::erase_if(triangles_, [&](const Triangle& t) {
    const Point a = vertices_m_[t[1]] - vertices_m_[t[0]];
    const Point b = vertices_m_[t[2]] - vertices_m_[t[1]];
    const Point c = vertices_m_[t[0]] - vertices_m_[t[2]];
    const double longest_m = std::sqrt(std::max({a.squaredNorm(), b.squaredNorm(), c.squaredNorm()}));
    return !(a.cross(b).norm() > kSliver * size_m_ * longest_m);
  });
}

void TriangleMesh::drop_unreferenced() {
  std::vector<std::uint32_t> place_of(vertices_m_.size(), kNone);
  std::vector<Point> kept;
  for (Triangle& triangle : triangles_) {
    for (std::uint32_t& corner : triangle) {
      if (place_of[corner] == kNone) {
        place_of[corner] = static_cast<std::uint32_t>(kept.size());
        kept.push_back(vertices_m_[corner]);
      }
      corner = place_of[corner];
    }
  }
  report_.unreferenced_vertices = vertices_m_.size() - kept.size() - report_.welded_vertices;
  vertices_m_ = std::move(kept);
}

void TriangleMesh::find_normals() {
  normals_.reserve(triangles_.size());
  for (const Triangle& t : triangles_) {
    const Point& a = vertices_m_[t[0]];
    normals_.emplace_back((vertices_m_[t[1]] - a).cross(vertices_m_[t[2]] - a).normalized());
  }
  neighbours_.assign(triangles_.size(), {kNone, kNone, kNone});
  for_each_edge(sides_of(triangles_), [&](auto first, auto last) {
    if (std::distance(first, last) != 2) return;
    const Side& one = *first;
    const Side& other = *std::next(first);
    if (one.rising == other.rising) return;
    neighbours_[one.triangle][one.side] = other.triangle;
    neighbours_[other.triangle][other.side] = one.triangle;
  });
}

std::size_t TriangleMesh::memory_bytes() const noexcept {
  return sizeof *this + vertices_m_.size() * sizeof(Point) + normals_.size() * sizeof(Point) +
         (triangles_.size() + neighbours_.size()) * sizeof(Triangle);
}

}  // namespace forcebound::scene
