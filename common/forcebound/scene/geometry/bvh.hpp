#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "forcebound/scene/geometry/nearest_on_triangle.hpp"
#include "forcebound/scene/geometry/triangle_mesh.hpp"

namespace forcebound::scene {

/// The part of a line from `from_m` (share 0) to `from_m + way_m` (share 1).
struct Segment {
  Point from_m;
  Point way_m;
};

struct NearestPoint {
  std::uint32_t triangle = 0;
  Point point_m = Point::Zero();
  double distance_m = 0;
  TrianglePart part;
};

/// Bounds what the searches of this thread do together while it lives, by the nodes that they visit; without one they
/// have no bound. A search that exceeds it ends at once, with less than there is to be found.
///
/// Of the thread, because any shape may search wherever it is asked. Real time.
///
/// Who builds shapes for somebody that may leave says so with a token, and building throws then.
class SearchBudget {
 public:
  /// @param ended null: the result is waited for; it has to outlive the budget
  explicit SearchBudget(std::uint64_t nodes, const std::stop_token* ended = nullptr) noexcept
      : before_(std::exchange(nodes_left, nodes)), ended_before_(std::exchange(ended_token, ended)) {}
  ~SearchBudget() {
    nodes_left = before_;
    ended_token = ended_before_;
  }
  SearchBudget(const SearchBudget&) = delete;
  SearchBudget& operator=(const SearchBudget&) = delete;

  /// Whether nothing is left, so that something may not have been found.
  [[nodiscard]] static bool exhausted() noexcept { return nodes_left == 0; }

  /// Whether nobody waits for what is built any more.
  [[nodiscard]] static bool abandoned() noexcept { return ended_token != nullptr && ended_token->stop_requested(); }

  /// One node more; false if nothing is left for it.
  [[nodiscard]] static bool spend() noexcept { return nodes_left > 0 && --nodes_left > 0; }

 private:
  static inline thread_local constinit std::uint64_t nodes_left = std::numeric_limits<std::uint64_t>::max();
  static inline thread_local constinit const std::stop_token* ended_token = nullptr;

  std::uint64_t before_;
  const std::stop_token* ended_before_;
};

/// Finds the few triangles of a mesh that are near to something: a binary tree of boxes along the axes, split where the
/// surface area heuristic says, in double precision. All points are in the mesh's own frame.
///
/// Real time: the queries are noexcept, allocate nothing, and keep a stack whose size the tree's depth bounds.
class Bvh {
 public:
  explicit Bvh(std::shared_ptr<const TriangleMesh> mesh);

  [[nodiscard]] const TriangleMesh& mesh() const noexcept { return *mesh_; }

  /// The triangles in the order of the tree, in which neighbours are close together in space. `visit` below gets
  /// indices into it.
  [[nodiscard]] std::span<const std::uint32_t> order() const noexcept { return order_; }

  /// The nearest point of the mesh, if it is within `reach_m`.
  [[nodiscard]] std::optional<NearestPoint> nearest(
      const Point& point_m, double reach_m = std::numeric_limits<double>::infinity()) const noexcept;

  /// Calls visit(place) for each triangle whose box meets the box, and perhaps for some more.
  template <class Visit>
  void for_each_about(const Bounds& box_m, Visit visit) const noexcept;

  /// Puts the places of the triangles whose boxes meet the box, and perhaps some more, into `places`; nullopt if it is
  /// too small for them.
  [[nodiscard]] std::optional<std::size_t> gather(const Bounds& box_m, std::span<std::uint32_t> places) const noexcept;

  /// Calls visit(place, until) for each triangle whose box the segment may meet before `until`, roughly in order from
  /// its start. It returns the new `until`, the share of the segment beyond which triangles need not be visited.
  template <class Visit>
  void for_each_along(const Segment& segment, double until, Visit visit) const noexcept;

  [[nodiscard]] NearestOnTriangle nearest_on(std::uint32_t triangle, const Point& point_m) const noexcept {
    const Triangle& t = mesh_->triangles()[triangle];
    const auto& v = mesh_->vertices_m();
    return nearest_on_triangle(point_m, v[t[0]], v[t[1]], v[t[2]]);
  }

  [[nodiscard]] std::size_t memory_bytes() const noexcept {
    return nodes_.size() * sizeof(Node) + order_.size() * sizeof(std::uint32_t);
  }

 private:
  static constexpr int kDepthMost = 80;
  static constexpr std::size_t kLeafMost = 4;

  struct alignas(64) Node {
    Point low;
    Point high;
    std::uint32_t first = 0;  // of a leaf: in the order; else the first of two children beside each other
    std::uint32_t count = 0;  // of a leaf's triangles; 0: has children
  };

  struct Waiting {
    std::uint32_t node;
    double from;  // nothing of the node is nearer
  };
  using Stack = std::array<Waiting, kDepthMost>;

  class Builder;

  /// Along the axis on which they are the furthest apart; < 0 if they overlap.
  [[nodiscard]] static double apart(const Node& node, const Bounds& box) noexcept {
    return (node.low - box.max()).cwiseMax(box.min() - node.high).maxCoeff();
  }

  [[nodiscard]] static double squared_distance(const Node& node, const Point& p) noexcept {
    return (node.low - p).cwiseMax(p - node.high).cwiseMax(0.0).squaredNorm();
  }

  /// Visits leaves from near to far: `enter(node)` is the sorting key of a node; nodes with a key beyond `limit()` are
  /// skipped; `visit(leaf)` is called for the others.
  template <class Enter, class Limit, class Visit>
  void descend(Enter enter, Limit limit, Visit visit) const noexcept;

  std::shared_ptr<const TriangleMesh> mesh_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

template <class Enter, class Limit, class Visit>
void Bvh::descend(Enter enter, Limit limit, Visit visit) const noexcept {
  Stack stack;
  std::size_t waiting = 0;
  Waiting here{0, enter(nodes_[0])};
  for (;;) {
    if (here.from <= limit()) {
      if (!SearchBudget::spend()) return;
      const Node& node = nodes_[here.node];
      if (node.count == 0) {
        Waiting near{node.first, enter(nodes_[node.first])};
        Waiting far{node.first + 1, enter(nodes_[node.first + 1])};
        if (far.from < near.from) std::swap(near, far);
        if (far.from <= limit()) stack[waiting++] = far;
        here = near;
        continue;
      }
      visit(node);
    }
    if (waiting == 0) return;
    here = stack[--waiting];
  }
}

template <class Visit>
void Bvh::for_each_about(const Bounds& box_m, Visit visit) const noexcept {
  descend([&](const Node& node) { return apart(node, box_m); }, [] { return 0.0; },
          [&](const Node& leaf) {
            for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) visit(i);
          });
}

template <class Visit>
void Bvh::for_each_along(const Segment& segment, double until, Visit visit) const noexcept {
  // Boxes are larger than what they hold, so that a segment exactly in the plane of a box's side, where 0 * infinity is
  // neither inside nor outside, does not touch what is in it.
  const Point inverse = segment.way_m.cwiseInverse();
  const auto enter = [&](const Node& node) {
    double first = 0;
    double last = until;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double low = (node.low[axis] - segment.from_m[axis]) * inverse[axis];
      const double high = (node.high[axis] - segment.from_m[axis]) * inverse[axis];
      first = std::max(first, std::min(low, high));
      last = std::min(last, std::max(low, high));
    }
    return first <= last ? first : std::numeric_limits<double>::infinity();
  };
  descend(
      enter, [&] { return until; },
      [&](const Node& leaf) {
        for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) until = visit(i, until);
      });
}

}  // namespace forcebound::scene
