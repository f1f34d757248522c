#include "forcebound/scene/geometry/god_object.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>

namespace forcebound::scene {
namespace {

constexpr double kSkin = 0x1p-40;
constexpr double kOnSkins = 0x1p-6;
constexpr double kEdgeSkins = 4;
// A point this far below a triangle, by rounding, is not yet behind it.
constexpr double kBehindSkins = 2;
// Where both sides are felt, what a triangle holds beyond its edges and corners may lie on the other side of the
// surface. The god object keeps farther away than that, so that it never meets a triangle from there.
constexpr double kClearanceSkins = 16;
constexpr double kCornerSkins = 8;
// Planes at a smaller angle have no crease: over the whole mesh they differ by less than the skin.
constexpr double kSameDirection = 0x1p-46;
// Largest error of a computed normal: that of the thinnest triangle.
constexpr double kLevel = 0x1p-15;
// Where a surface rises beyond an edge, rounding must not let the god object slip past the rising wall while it follows
// the edge down to the bottom of a wedge, however narrow. Reaching further beyond the edge is harmless: that is behind
// the rising wall, where nothing is felt. Where both sides are felt, the clearance keeps it over both walls.
constexpr double kRisingEdgeSkins = 0x1p12;
constexpr double kRisingBelowSkins = 0x1p-6;
// Where the surface ends at the edge.
constexpr double kOpenBelowSkins = 0x1p-3;
// Triangles this near to the god object are its surroundings: more than it may be beyond an edge.
constexpr double kAboutSkins = 0x1p13;
constexpr double kFarSizes = 1e12;
// A contact no deeper than this takes its direction from the triangle.
constexpr double kShallowSkins = 64;
// Limits of one motion of the god object: a multiple of the goal's way, a share of its distance from the goal, and a
// share of the mesh's size.
constexpr double kStretch = 4;
constexpr double kShareOfDepth = 0x1p-3;
constexpr double kShareOfSize = 0x1p-10;

}  // namespace

Proxy proxy_at(const Point& at_m, const Point& goal_m) noexcept {
  return {at_m.x(), at_m.y(), at_m.z(), 1, goal_m.x(), goal_m.y(), goal_m.z()};
}

/// The planes, at most three, that hold the god object where it is, and its way to the point nearest to the goal in
/// their common outside. When the way meets another plane, the next optimum lies on that plane: its candidates are the
/// plane itself, its creases with each of the others, and standing still.
class GodObject::Constraints {
 public:
  explicit Constraints(const GodObject& object) noexcept : object_(object), skin_m_(object.skin_m_) {}

  void clear() noexcept {
    count_ = 0;
    least_ = 0;
  }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }

  /// The way from the god object's position, with one more plane. `wanted` leads to the goal.
  [[nodiscard]] Point add(const Constraint& plane, const Point& wanted) noexcept {
    const Point single = wanted - plane.normal * (plane.normal.dot(wanted) + plane.height_m);
    // Each choice ends farther from the goal than the one before, so that no choice repeats.
    if ((single - wanted).squaredNorm() > least_ && fits(single, count_)) {
      return keep(single, wanted, plane, nullptr);
    }
    Point best = Point::Zero();
    const Constraint* other = nullptr;
    for (std::size_t i = 0; i < count_; ++i) {
      Point way;
      if (!along_crease(plane, held_[i], wanted, way) || !fits(way, i)) continue;
      if (other != nullptr && (way - wanted).squaredNorm() >= (best - wanted).squaredNorm()) continue;
      best = way;
      other = &held_[i];
    }
    if (other != nullptr) return keep(best, wanted, plane, other);
    held_[count_++] = plane;
    return Point::Zero();
  }

  /// Whether the god object, having moved to `p`, still touches the triangles of all planes.
  [[nodiscard]] bool follow(const Point& p) noexcept {
    bool on_all = true;
    for (Constraint& plane : std::span(held_).first(count_)) {
      plane = object_.seen_from(p, plane);
      on_all = on_all && std::abs(plane.height_m) <= kFitSkins * skin_m_ && is_on(*plane.facet, p);
    }
    return on_all;
  }

  /// Whether the planes describe the whole surface about `p`: none of their triangles ends there, except at another one
  /// that rises from it. Then the free space is convex, and the nearest point on the planes is the nearest of all.
  [[nodiscard]] bool are_all_about(const Point& p) const noexcept {
    return std::ranges::all_of(held(), [&](const Constraint& plane) {
      for (std::size_t side = 0; side < 3; ++side) {
        const Plane& end = plane.facet->edges[side].plane;
        if (end.normal.dot(p) - end.offset < -kRisingEdgeSkins * skin_m_) continue;
        const std::uint32_t beyond = object_.neighbour(*plane.facet, side);
        const auto rises = [&](const Constraint& other) {
          return object_.triangle_of(*other.facet) == beyond && other.normal.dot(end.normal) < 0;
        };
        if (std::ranges::none_of(held(), rises)) return false;
      }
      return true;
    });
  }

 private:
  static constexpr double kFitSkins = 4;

  Point keep(const Point& way, const Point& wanted, const Constraint& plane, const Constraint* other) noexcept {
    const Constraint second = other == nullptr ? Constraint{} : *other;
    count_ = 0;
    held_[count_++] = plane;
    if (other != nullptr) held_[count_++] = second;
    least_ = (way - wanted).squaredNorm();
    return way;
  }

  [[nodiscard]] bool fits(const Point& way, std::size_t except) const noexcept {
    for (std::size_t i = 0; i < count_; ++i) {
      if (i != except && held_[i].normal.dot(way) + held_[i].height_m < -kFitSkins * skin_m_) return false;
    }
    return true;
  }

  [[nodiscard]] static bool along_crease(const Constraint& one, const Constraint& other, const Point& wanted,
                                         Point& way) noexcept {
    Point crease = one.normal.cross(other.normal);
    const double sine = crease.norm();
    if (!(sine > kSameDirection)) return false;
    crease /= sine;
    // At a small angle, rounding turns the way out of the first plane; project it back.
    crease = (crease - one.normal * one.normal.dot(crease)).normalized();
    way = crease * crease.dot(wanted) - one.normal * one.height_m;
    way -= other.normal * std::min(0.0, other.normal.dot(way) + other.height_m);
    return true;
  }

  [[nodiscard]] std::span<const Constraint> held() const noexcept { return std::span(held_).first(count_); }

  [[nodiscard]] static bool is_on(const Facet& facet, const Point& p) noexcept {
    return std::ranges::all_of(
        facet.edges, [&](const Edge& edge) { return edge.plane.normal.dot(p) - edge.plane.offset <= edge.beyond_m; });
  }

  const GodObject& object_;
  double skin_m_;
  double least_ = 0;  // squared distance from the end of the way to the goal
  std::size_t count_ = 0;
  std::array<Constraint, 3> held_;  // the third only while standing still
};

/// Finds obstacles. The triangles gathered about one way serve all ways inside the same box, so that most motions
/// search the tree once or twice.
class GodObject::Search {
 public:
  explicit Search(const GodObject& object) noexcept : object_(object) {}

  /// Whether one more turn, of a way and steps around, might exceed the limit of searches.
  [[nodiscard]] bool is_over() const noexcept { return searches_ > kQueriesMost - kMostPerTurn; }

  void gather_about(const Segment& path) noexcept {
    if (box_.contains(Point(path.from_m + path.way_m))) return;
    const Point room = Point::Constant(kRoom * path.way_m.norm() + 2 * kAboutSkins * object_.skin_m_);
    Bounds box(path.from_m);
    box.extend(Point(path.from_m + path.way_m));
    box_ = {box.min() - room, box.max() + room};
    ++searches_;
    const auto count = object_.bvh_.gather(box_, gathered_);
    count_ = count.value_or(0);
    if (!count) box_.setEmpty();
  }

  /// Calls visit(place) for each triangle whose box meets the box, and perhaps for some more.
  template <class Visit>
  void for_each_about(const Bounds& box, Visit visit) noexcept {
    if (box_.contains(box)) {
      std::ranges::for_each(gathered(), visit);
    } else {
      ++searches_;
      object_.bvh_.for_each_about(box, visit);
    }
  }

  /// The first obstacle that is not among `without`. A path that would change sides through one of those is blocked
  /// from its start.
  [[nodiscard]] bool first_obstacle(const Segment& path, Obstacle& found,
                                    std::span<const std::uint32_t> without = {}) noexcept {
    bool blocked = false;
    double until = 1;
    const auto visit = [&](std::uint32_t place, double share) {
      const Facet& facet = object_.facets_[place];
      if (!without.empty() && std::ranges::find(without, place) != without.end()) {
        if (!object_.changes_sides(facet, path, share)) return share;
        found.share = 0;
      } else if (!object_.is_in_the_way(facet, path, share, found)) {
        return share;
      }
      blocked = true;
      return found.share;
    };
    ++searches_;
    if (box_.contains(path.from_m)) {
      for (const std::uint32_t place : gathered()) until = visit(place, until);
      if (box_.contains(Point(path.from_m + until * path.way_m))) return blocked;
    }
    object_.bvh_.for_each_along(path, until, visit);
    return blocked;
  }

 private:
  static constexpr std::size_t kMost = 64;
  static constexpr double kRoom = 0.5;  // of the way
  static constexpr int kMostPerTurn = 12;

  [[nodiscard]] std::span<const std::uint32_t> gathered() const noexcept { return std::span(gathered_).first(count_); }

  const GodObject& object_;
  int searches_ = 0;
  Bounds box_;  // empty: nothing is gathered
  std::size_t count_ = 0;
  std::array<std::uint32_t, kMost> gathered_;
};

/// The triangles about a point of the surface, and the steps over them that lead nearer to the goal, the fastest first.
class GodObject::Fan {
 public:
  struct Step {
    Point way;
    double rate = 0;  // decrease of the distance to the goal per length of way
    std::uint32_t place = 0;
  };

  Fan(const GodObject& object, Search& search, const Point& proxy, const Point& goal) noexcept : object_(object) {
    const double reach_m = kAboutSkins * object.skin_m_;
    search.for_each_about({proxy.array() - reach_m, proxy.array() + reach_m}, [&](std::uint32_t place) {
      const Facet& facet = object.facets_[place];
      const bool near = std::abs(facet.plane.normal.dot(proxy) - facet.plane.offset) <= reach_m;
      if (near && is_within(facet, proxy, reach_m) && count_ < kMost) about_[count_++] = place;
    });
    for (const std::uint32_t place : std::span(about_).first(count_)) {
      const NearestOnTriangle best = object.bvh_.nearest_on(object.bvh_.order()[place], goal);
      Step step{best.point_m - proxy, 0, place};
      // Keep the height above the triangle.
      const Point& normal = object.facets_[place].plane.normal;
      step.way -= normal * normal.dot(step.way);
      const double length_m = step.way.norm();
      if (length_m <= 2 * reach_m) continue;
      step.rate = (goal - proxy).dot(step.way) / length_m;
      if (step.rate > 0) insert(step);
    }
  }

  [[nodiscard]] std::span<const Step> steps() const noexcept { return std::span(steps_).first(step_count_); }

  /// The triangles about the point that connect to the step's triangle from edge to edge, if all of them share one
  /// vertex and do not pass through each other: then none of them blocks a step on the god object's side, whatever
  /// their planes do. Else nullopt.
  [[nodiscard]] std::optional<std::span<const std::uint32_t>> around(std::size_t step) noexcept {
    if (std::ranges::find(members(), steps_[step].place) == members().end()) {
      gather_members(steps_[step].place);
      is_simple_ = is_simple();
    }
    return is_simple_ ? std::optional(members()) : std::nullopt;
  }

 private:
  static constexpr std::size_t kMost = 64;
  static constexpr std::size_t kPairsOf = 16;  // for more triangles, pairs are not tested
  static constexpr std::size_t kStepsMost = 8;

  /// A triangle seen from the vertex: an arc of a great circle.
  struct Arc {
    std::uint32_t from;
    std::uint32_t to;
  };

  [[nodiscard]] const TriangleMesh& mesh() const noexcept { return object_.bvh_.mesh(); }
  [[nodiscard]] std::uint32_t triangle(std::uint32_t place) const noexcept { return object_.bvh_.order()[place]; }

  [[nodiscard]] Point arm(std::uint32_t vertex, std::uint32_t end) const noexcept {
    return mesh().vertices_m()[end] - mesh().vertices_m()[vertex];
  }
  [[nodiscard]] std::span<const std::uint32_t> members() const noexcept { return std::span(about_).first(members_); }

  void gather_members(std::uint32_t first) noexcept {
    const auto end = about_.begin() + static_cast<std::ptrdiff_t>(count_);
    auto last = std::partition(about_.begin(), end, [&](std::uint32_t place) { return place == first; });
    for (auto member = about_.begin(); member != last; ++member) {
      const Triangle& beyond = mesh().neighbours()[triangle(*member)];
      last = std::partition(
          last, end, [&](std::uint32_t place) { return std::ranges::find(beyond, triangle(place)) != beyond.end(); });
    }
    members_ = static_cast<std::size_t>(last - about_.begin());
  }

  [[nodiscard]] bool is_simple() const noexcept {
    if (members_ <= 2) return true;
    const Triangle& first = mesh().triangles()[triangle(about_[0])];
    return std::ranges::any_of(first, [&](std::uint32_t vertex) { return is_simple_about(vertex); });
  }

  [[nodiscard]] bool is_simple_about(std::uint32_t vertex) const noexcept {
    std::array<Arc, kMost> all;
    for (std::size_t i = 0; i < members_; ++i) {
      const Triangle& t = mesh().triangles()[triangle(about_[i])];
      const auto corner = static_cast<std::size_t>(std::ranges::find(t, vertex) - t.begin());
      if (corner == 3) return false;
      all[i] = {t[(corner + 1) % 3], t[(corner + 2) % 3]};
    }
    const std::span<const Arc> arcs = std::span(all).first(members_);
    if (winds_once(vertex, arcs)) return true;
    if (members_ > kPairsOf) return false;
    for (std::size_t i = 0; i < members_; ++i) {
      if (std::ranges::any_of(arcs.first(i), [&](const Arc& other) { return cross(vertex, arcs[i], other); })) {
        return false;
      }
    }
    return true;
  }

  /// Whether the triangles go around the vertex once and all face one direction. Most vertices are so.
  [[nodiscard]] bool winds_once(std::uint32_t vertex, std::span<const Arc> arcs) const noexcept {
    const auto normal = [&](std::uint32_t place) -> const Point& { return mesh().normals()[triangle(place)]; };
    Point up = Point::Zero();
    for (const std::uint32_t place : members()) up += normal(place);
    if (!std::ranges::all_of(members(), [&](std::uint32_t place) { return normal(place).dot(up) > 0; })) return false;
    const bool closed = std::ranges::all_of(arcs, [&](const Arc& arc) {
      return std::ranges::any_of(arcs, [&](const Arc& next) { return next.from == arc.to; });
    });
    const Point some = arm(vertex, arcs[0].from).normalized() + arm(vertex, arcs[0].to).normalized();
    return closed && std::ranges::count_if(arcs, [&](const Arc& arc) {
                       return up.dot(arm(vertex, arc.from).cross(some)) >= 0 &&
                              up.dot(some.cross(arm(vertex, arc.to))) > 0;
                     }) == 1;
  }

  [[nodiscard]] bool cross(std::uint32_t vertex, const Arc& one, const Arc& other) const noexcept {
    if (one.from == other.to || one.to == other.from) return false;
    const Point a = arm(vertex, one.from);
    const Point b = arm(vertex, one.to);
    const Point c = arm(vertex, other.from);
    const Point d = arm(vertex, other.to);
    const Point ab = a.cross(b);
    const Point cd = c.cross(d);
    const std::array<double, 4> off{cd.dot(a), cd.dot(b), ab.dot(c), ab.dot(d)};
    if (off[0] * off[1] > 0 || off[2] * off[3] > 0) return false;
    // Whether the points where each meets the other's plane lie in the same direction.
    return (std::abs(off[1]) * a + std::abs(off[0]) * b).dot(std::abs(off[3]) * c + std::abs(off[2]) * d) >= 0;
  }

  void insert(Step step) noexcept {
    for (Step& other : std::span(steps_).first(step_count_)) {
      if (step.rate > other.rate) std::swap(step, other);
    }
    if (step_count_ < kStepsMost) steps_[step_count_++] = step;
  }

  const GodObject& object_;
  std::size_t count_ = 0;
  std::array<std::uint32_t, kMost> about_;
  std::size_t members_ = 0;  // the first of `about_`, which connect from edge to edge
  bool is_simple_ = false;
  std::size_t step_count_ = 0;
  std::array<Step, kStepsMost> steps_;
};

GodObject::GodObject(std::shared_ptr<const TriangleMesh> mesh, const GodObjectOptions& options)
    : GodObject(Bvh(std::move(mesh)), options) {}

GodObject::GodObject(Bvh tree, const GodObjectOptions& options)
    : bvh_(std::move(tree)),
      skin_m_(kSkin * bvh_.mesh().size_m()),
      clearance_m_(options.two_sided ? kClearanceSkins * skin_m_ : 0),
      two_sided_(options.two_sided) {
  facets_.reserve(bvh_.order().size());
  for (const std::uint32_t triangle : bvh_.order()) facets_.push_back(facet_of(triangle));
}

GodObject::Facet GodObject::facet_of(std::uint32_t triangle) const {
  const TriangleMesh& mesh = bvh_.mesh();
  const Point& normal = mesh.normals()[triangle];
  const Point middle = (mesh.corner_m(triangle, 0) + mesh.corner_m(triangle, 1) + mesh.corner_m(triangle, 2)) / 3;
  return {{normal, normal.dot(middle)}, {edge_of(triangle, 0), edge_of(triangle, 1), edge_of(triangle, 2)}};
}

GodObject::Edge GodObject::edge_of(std::uint32_t triangle, std::size_t side) const {
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

SurfacePoint GodObject::follow(const Point& goal_m, Proxy& state) const noexcept {
  const Point goal = goal_m - bvh_.mesh().origin_m();
  if (!goal.allFinite()) return {};
  if (goal.cwiseAbs().maxCoeff() > kFarSizes * bvh_.mesh().size_m()) {
    state = {};
    return {};
  }
  if (state.placed == 0) state = proxy_at(goal, goal);
  Point proxy(state.x_m, state.y_m, state.z_m);
  const Point before(state.goal_x_m, state.goal_y_m, state.goal_z_m);
  const double most_m =
      kStretch * (goal - before).norm() + kShareOfDepth * (goal - proxy).norm() + kShareOfSize * bvh_.mesh().size_m();
  Point normal = Point::UnitX();
  proxy = approach(proxy, goal) ? settle({proxy, most_m}, goal, normal) : goal;
  state = proxy_at(proxy, goal);
  const Point out = proxy - goal;
  const double penetration_m = out.norm();
  if (penetration_m > kShallowSkins * skin_m_) normal = out / penetration_m;
  return {.normal = normal, .penetration_m = penetration_m};
}

/// Moves a god object that is far from the mesh along its way to near the mesh, so that shares of the rest of its way
/// are exact to less than the skin. False if its way does not come near.
bool GodObject::approach(Point& proxy, const Point& goal) const noexcept {
  const Point near = bvh_.mesh().box_m().max().array() + bvh_.mesh().size_m();
  if ((proxy.cwiseAbs() - near).maxCoeff() <= 0) return true;
  const Point way = goal - proxy;
  double enter = 0;
  double leave = 1;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (way[axis] == 0) {
      if (std::abs(proxy[axis]) > near[axis]) return false;
      continue;
    }
    const double low = (-near[axis] - proxy[axis]) / way[axis];
    const double high = (near[axis] - proxy[axis]) / way[axis];
    enter = std::max(enter, std::min(low, high));
    leave = std::min(leave, std::max(low, high));
  }
  if (enter > leave) return false;
  proxy += enter * way;
  return true;
}

Point GodObject::settle(Walk walk, const Point& goal, Point& last_normal) const noexcept {
  Constraints held(*this);
  Search search(*this);
  Point way = goal - walk.at_m;
  while (!search.is_over()) {
    const double length_m = way.norm();
    bool rests = length_m <= kOnSkins * skin_m_;
    if (!rests) {
      Obstacle obstacle;
      if (held.size() > 0) search.gather_about({walk.at_m, way});
      const bool blocked = search.first_obstacle({walk.at_m, way}, obstacle);
      const bool stands = blocked && obstacle.share * length_m <= skin_m_;
      if (blocked) last_normal = obstacle.constraint.normal;
      if (!stands && !walk.go(way, blocked ? obstacle.share : 1)) return walk.at_m;
      if (!blocked && held.size() == 0) return goal;
      const bool holds = held.follow(walk.at_m);
      if (blocked && (holds || stands)) {
        way = held.add(seen_from(walk.at_m, obstacle.constraint), goal - walk.at_m);
        continue;
      }
      rests = !blocked && (holds || length_m <= skin_m_);
    }
    if (rests) {
      if (held.are_all_about(walk.at_m)) return walk.at_m;
      if (!step_around(walk, goal, search)) return walk.at_m;
    }
    held.clear();
    way = goal - walk.at_m;
  }
  return walk.at_m;
}

/// Planes extend beyond their triangles. Where the triangles about the god object do not leave a convex space free, the
/// planes may block a way that is open: straight to the goal, or else over the triangle that leads to the goal fastest.
/// Takes it. False if there is none, or if the motion's limit is reached on it.
bool GodObject::step_around(Walk& walk, const Point& goal, Search& search) const noexcept {
  const auto is_open = [&](const Point& way, std::span<const std::uint32_t> without, double& share) {
    Obstacle obstacle;
    const bool blocked = search.first_obstacle({walk.at_m, way}, obstacle, without);
    share = blocked ? obstacle.share : 1;
    return share * way.norm() > skin_m_;
  };
  double share = 0;
  const Point straight = goal - walk.at_m;
  if (is_open(straight, {}, share)) return walk.go(straight, share);
  Fan about(*this, search, walk.at_m, goal);
  for (std::size_t i = 0; i < about.steps().size(); ++i) {
    const auto around = about.around(i);
    if (around && is_open(about.steps()[i].way, *around, share)) return walk.go(about.steps()[i].way, share);
  }
  return false;
}

bool GodObject::is_within(const Facet& facet, const Point& p, double beyond_m) noexcept {
  return std::ranges::all_of(
      facet.edges, [&](const Edge& edge) { return edge.plane.normal.dot(p) - edge.plane.offset <= beyond_m; });
}

GodObject::Constraint GodObject::seen_from(const Point& p, const Constraint& plane) const noexcept {
  const double side = plane.normal.dot(plane.facet->plane.normal) < 0 ? -1 : 1;
  return {plane.normal, plane.normal.dot(p) - side * plane.facet->plane.offset - clearance_m_, plane.facet};
}

bool GodObject::Passage::enter_over(const Facet& facet, const Segment& path) noexcept {
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

bool GodObject::is_in_the_way(const Facet& facet, const Segment& path, double until, Obstacle& found) const noexcept {
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

bool GodObject::is_past_a_corner(const Facet& facet, const Segment& path, const Passage& over) const noexcept {
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

bool GodObject::changes_sides(const Facet& facet, const Segment& path, double until) const noexcept {
  if (!two_sided_) return false;
  const double height_m = facet.plane.normal.dot(path.from_m) - facet.plane.offset;
  const double rate_m = facet.plane.normal.dot(path.way_m);
  if ((height_m > 0) == (height_m + until * rate_m > 0)) return false;
  Passage over{.leave = until};
  if (!over.enter_over(facet, path)) return false;
  return (height_m + over.enter * rate_m > 0) != (height_m + over.leave * rate_m > 0);
}

}  // namespace forcebound::scene
