#include "forcebound/scene/geometry/decimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <queue>
#include <tuple>
#include <utility>

#include "forcebound/text/numbers.hpp"

namespace forcebound::scene {
namespace {

using Number = std::uint32_t;
using Numbers = std::vector<Number>;

// k of the cost: weight of a displacement along the surface relative to one out of it.
constexpr double kAlong = 1e-4;
// Cosine of the largest angle by which a triangle may turn in one collapse.
constexpr double kTurnedMost = 0.3;
// The least height of a triangle over its longest side.
constexpr double kSlimmest = 0.02;
constexpr std::size_t kLeastTriangles = 4;

/// x' A x - 2 b' x + c
struct Quadric {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Point b = Point::Zero();
  double c = 0;

  /// weight (n . (x - p))^2
  void add_plane(double weight, const Point& normal, const Point& through) {
    const double offset = normal.dot(through);
    a += weight * normal * normal.transpose();
    b += weight * offset * normal;
    c += weight * offset * offset;
  }
  /// weight |x - p|^2
  void add_point(double weight, const Point& point) {
    a.diagonal().array() += weight;
    b += weight * point;
    c += weight * point.squaredNorm();
  }
  [[nodiscard]] Quadric operator+(const Quadric& other) const {
    return {.a = a + other.a, .b = b + other.b, .c = c + other.c};
  }
  /// Positive definite: every vertex belongs to a triangle with an area.
  [[nodiscard]] Point minimum() const { return a.llt().solve(b); }
  [[nodiscard]] double at(const Point& x) const { return std::max(0.0, x.dot(a * x) - 2 * b.dot(x) + c); }
};

using Corners = std::array<Point, 3>;

/// As a vector to its outside.
Point doubled_area(const Corners& p) { return (p[1] - p[0]).cross(p[2] - p[0]); }

/// The least height over the longest side.
double slimness(const Corners& p) {
  const double longest_m2 =
      std::max({(p[1] - p[0]).squaredNorm(), (p[2] - p[1]).squaredNorm(), (p[0] - p[2]).squaredNorm()});
  return doubled_area(p).norm() / longest_m2;
}

/// An edge that may collapse.
struct Candidate {
  double cost;
  Number low;
  Number high;
  std::uint64_t age;  ///< sum of both ends' ages when it was found; if that has changed, the entry is stale

  [[nodiscard]] bool operator>(const Candidate& other) const noexcept {
    return std::tie(cost, low, high) > std::tie(other.cost, other.low, other.high);
  }
};

class Decimation {
 public:
  explicit Decimation(const TriangleMesh& mesh)
      : vertices_m_(mesh.vertices_m()),
        triangles_(mesh.triangles()),
        left_(triangles_.size()),
        quadrics_(vertices_m_.size()),
        of_vertex_(vertices_m_.size()),
        ages_(vertices_m_.size(), 0) {
    for (Number i = 0; i < triangles_.size(); ++i) {
      const Triangle& t = triangles_[i];
      const double weight = doubled_area({vertices_m_[t[0]], vertices_m_[t[1]], vertices_m_[t[2]]}).norm() / 6;
      for (const Number corner : triangles_[i]) {
        quadrics_[corner].add_plane(weight, mesh.normals()[i], vertices_m_[corner]);
        quadrics_[corner].add_point(kAlong * weight, vertices_m_[corner]);
        of_vertex_[corner].push_back(i);
      }
    }
  }

  void run(std::size_t triangles) {
    // An edge that may not collapse now may do so later, after its neighbours have.
    for (bool any = true; any && left_ > triangles;) {
      any = false;
      find_candidates();
      while (left_ > triangles && !queue_.empty()) {
        const Candidate next = queue_.top();
        queue_.pop();
        if (next.age == ages_[next.low] + ages_[next.high]) any = collapse(next) || any;
      }
    }
  }

  [[nodiscard]] std::vector<Triangle> triangles() const {
    std::vector<Triangle> kept;
    std::ranges::copy_if(triangles_, std::back_inserter(kept), [](const Triangle& t) { return t[0] != t[1]; });
    return kept;
  }
  [[nodiscard]] const std::vector<Point>& vertices_m() const noexcept { return vertices_m_; }

 private:
  /// In rising order.
  [[nodiscard]] Numbers neighbours_of(Number vertex) const {
    Numbers found;
    for (const Number triangle : of_vertex_[vertex]) {
      for (const Number corner : triangles_[triangle]) {
        if (corner != vertex) found.push_back(corner);
      }
    }
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  void find_candidates() {
    queue_ = {};
    for (Number vertex = 0; vertex < vertices_m_.size(); ++vertex) {
      for (const Number other : neighbours_of(vertex)) {
        if (vertex < other) add_candidate(vertex, other);
      }
    }
  }

  void add_candidate(Number a, Number b) {
    const Quadric both = quadrics_[a] + quadrics_[b];
    queue_.push(
        {.cost = both.at(both.minimum()), .low = std::min(a, b), .high = std::max(a, b), .age = ages_[a] + ages_[b]});
  }

  /// The edge's ends have exactly two common neighbours, and those keep at least three neighbours.
  [[nodiscard]] bool keeps_the_surface(const Candidate& edge) const {
    const Numbers low = neighbours_of(edge.low);
    const Numbers high = neighbours_of(edge.high);
    Numbers common;
    std::ranges::set_intersection(low, high, std::back_inserter(common));
    constexpr std::size_t kLeastNeighbours = 3;
    return common.size() == 2 &&
           std::ranges::all_of(common, [&](Number vertex) { return neighbours_of(vertex).size() > kLeastNeighbours; });
  }

  /// No triangle of `vertex` but those of the edge turns over or becomes a needle when it moves.
  [[nodiscard]] bool may_move(Number vertex, Number other, const Point& to_m) const {
    return std::ranges::all_of(of_vertex_[vertex], [&](Number triangle) {
      const Triangle& t = triangles_[triangle];
      if (std::ranges::find(t, other) != t.end()) return true;
      Corners corners_m{vertices_m_[t[0]], vertices_m_[t[1]], vertices_m_[t[2]]};
      const Point before = doubled_area(corners_m);
      const double slim_before = slimness(corners_m);
      corners_m.at(t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2) = to_m;
      const Point after = doubled_area(corners_m);
      // Triangles that are needles already may stay so.
      return slimness(corners_m) >= std::min(kSlimmest, slim_before) &&
             after.dot(before) > kTurnedMost * after.norm() * before.norm();
    });
  }

  bool collapse(const Candidate& edge) {
    const Quadric both = quadrics_[edge.low] + quadrics_[edge.high];
    const Point to_m = both.minimum();
    if (!keeps_the_surface(edge) || !may_move(edge.low, edge.high, to_m) || !may_move(edge.high, edge.low, to_m)) {
      return false;
    }
    for (const Number triangle : of_vertex_[edge.high]) replace_corner(triangle, edge);
    of_vertex_[edge.high].clear();
    vertices_m_[edge.low] = to_m;
    quadrics_[edge.low] = both;
    ++ages_[edge.low];
    ++ages_[edge.high];
    for (const Number other : neighbours_of(edge.low)) add_candidate(edge.low, other);
    return true;
  }

  void replace_corner(Number triangle, const Candidate& edge) {
    Triangle& t = triangles_[triangle];
    if (std::ranges::find(t, edge.low) == t.end()) {
      std::ranges::replace(t, edge.high, edge.low);
      of_vertex_[edge.low].push_back(triangle);
      return;
    }
    for (const Number corner : t) {
      if (corner != edge.high) std::erase(of_vertex_[corner], triangle);
    }
    t = {};
    --left_;
  }

  std::vector<Point> vertices_m_;
  std::vector<Triangle> triangles_;  ///< those that are gone have three equal corners
  std::size_t left_;
  std::vector<Quadric> quadrics_;
  std::vector<Numbers> of_vertex_;  ///< its triangles
  std::vector<std::uint64_t> ages_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
};

}  // namespace

TriangleMesh decimated(const TriangleMesh& mesh, double share) {
  if (!(share > 0 && share <= 1)) {
    throw GeometryError(mesh.name() + ": the share of triangles to keep must be in (0, 1], got " +
                        text::to_text(share));
  }
  if (share == 1) return mesh;
  const bool has_gap = std::ranges::any_of(mesh.neighbours(), [](const Triangle& beyond) {
    return std::ranges::find(beyond, TriangleMesh::kNone) != beyond.end();
  });
  if (has_gap) {
    throw GeometryError(mesh.name() + ": only a mesh that is closed without slivers can be had with less detail, got " +
                        to_text(mesh.report()));
  }
  Decimation decimation(mesh);
  const auto wanted = std::llround(share * static_cast<double>(mesh.triangles().size()));
  decimation.run(std::max(kLeastTriangles, static_cast<std::size_t>(wanted)));
  return {mesh.name(), decimation.vertices_m(), decimation.triangles(), {.scale = 1, .offset_m = mesh.origin_m()}};
}

}  // namespace forcebound::scene
