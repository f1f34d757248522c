#include "forcebound/scene/geometry/god_object.hpp"

#include <cmath>
#include <cstddef>

namespace forcebound::scene {
namespace {

constexpr double kSkin = 0x1p-40;
constexpr double kOnSkins = 0x1p-6;
constexpr double kEdgeSkins = 4;
// Below the skin by rounding is not yet behind the triangle.
constexpr double kBehindSkins = 2;
// Planes at a smaller angle have no crease: over the whole mesh they differ by less than the skin.
constexpr double kSameDirection = 0x1p-46;
// No computed normal is further off than this, that of the thinnest triangle.
constexpr double kLevel = 0x1p-15;
// Where a surface rises beyond an edge, along it to the bottom of a wedge, however narrow, the other wall must not be
// left for rounding. Behind that wall it harms nothing if this one goes on.
constexpr double kRisingEdgeSkins = 0x1p12;
constexpr double kRisingBelowSkins = 0x1p-6;
// Where it ends, or nobody knows.
constexpr double kOpenBelowSkins = 0x1p-3;
constexpr double kFarSizes = 1e12;
// A contact no deeper than this has no direction but the triangle's.
constexpr double kShallowSkins = 64;

Point point_of(const Proxy& state) noexcept { return {state.x_m, state.y_m, state.z_m}; }

Proxy proxy_at(const Point& p) noexcept { return {p.x(), p.y(), p.z(), 1}; }

}  // namespace

/// The planes that hold the god object where it is, at most three, and the way that they leave it: the point of their
/// common outside that is nearest to the goal. When a plane comes that this way runs into, it is one of those that
/// matter for the next: there are at most the plane itself, its creases with each of the others, and standing still.
class GodObject::Constraints {
 public:
  explicit Constraints(double skin_m) noexcept : skin_m_(skin_m) {}

  void clear() noexcept {
    count_ = 0;
    least_ = 0;
  }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }

  /// The way from where the god object is, with one more plane. `wanted` leads to the goal.
  [[nodiscard]] Point add(const Constraint& plane, const Point& wanted) noexcept {
    const Point single = wanted - plane.normal * (plane.normal.dot(wanted) + plane.height_m);
    // The best that is left is always farther from the goal than before, so that no choice comes back.
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
    return other == nullptr ? Point::Zero() : keep(best, wanted, plane, other);
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
    // What rounding of a small angle turned out of the first plane goes back into it.
    crease = (crease - one.normal * one.normal.dot(crease)).normalized();
    way = crease * crease.dot(wanted) - one.normal * one.height_m;
    way -= other.normal * std::min(0.0, other.normal.dot(way) + other.height_m);
    return true;
  }

  double skin_m_;
  double least_ = 0;  // how far, squared, the way ends from the goal
  std::size_t count_ = 0;
  std::array<Constraint, 2> held_;  // two and a new one are three
};

GodObject::GodObject(std::shared_ptr<const TriangleMesh> mesh, const GodObjectOptions& options)
    : bvh_(std::move(mesh)),
      skin_m_(kSkin * bvh_.mesh().size_m()),
      clearance_m_(options.two_sided ? kBehindSkins * skin_m_ : 0),
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
  // From behind, what falls off rises.
  const bool rises = (two_sided_ ? std::abs(rise_m) : rise_m) > kLevel * reach_m;
  if (rises) return {plane, kRisingEdgeSkins * skin_m_, kRisingBelowSkins * skin_m_};
  return {plane, kEdgeSkins * skin_m_, skin_m_};
}

SurfacePoint GodObject::follow(const Point& goal_m, Proxy& state) const noexcept {
  const Point goal = goal_m - bvh_.mesh().origin_m();
  if (!goal.allFinite()) return {};
  if (goal.cwiseAbs().maxCoeff() > kFarSizes * bvh_.mesh().size_m()) {
    state = {};
    return {};
  }
  Point proxy = state.placed != 0 ? point_of(state) : goal;
  Point normal = Point::UnitX();
  proxy = approach(proxy, goal) ? settle(proxy, goal, normal) : goal;
  state = proxy_at(proxy);
  const Point out = proxy - goal;
  const double penetration_m = out.norm();
  if (penetration_m > kShallowSkins * skin_m_) normal = out / penetration_m;
  return {.normal = normal, .penetration_m = penetration_m};
}

/// Brings a god object that is far from the mesh near to it, so that shares of its way are exact to less than the skin.
/// False if its way does not come near.
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

Point GodObject::settle(Point proxy, const Point& goal, Point& last_normal) const noexcept {
  Constraints held(skin_m_);
  const Facet* facet = nullptr;
  Point way = goal - proxy;
  for (int query = 0; query < kQueriesMost && way.squaredNorm() > 0; ++query) {
    Obstacle obstacle;
    const bool blocked = first_obstacle({proxy, way}, obstacle);
    const double length_m = way.norm();
    if (blocked && obstacle.share * length_m <= skin_m_) {
      last_normal = obstacle.constraint.normal;
      facet = obstacle.facet;
      way = held.add(obstacle.constraint, goal - proxy);
      continue;
    }
    if (!blocked && held.size() == 0) return goal;
    proxy += (blocked ? obstacle.share : 1) * way;
    if (!blocked && (length_m <= skin_m_ || (held.size() == 1 && is_over(*facet, proxy)))) return proxy;
    held.clear();
    way = goal - proxy;
  }
  return proxy;
}

bool GodObject::first_obstacle(const Segment& path, Obstacle& found) const noexcept {
  bool blocked = false;
  bvh_.for_each_along(path, 1, [&](std::uint32_t place, double until) {
    if (!is_in_the_way(facets_[place], path, until, found)) return until;
    blocked = true;
    return found.share;
  });
  return blocked;
}

bool GodObject::is_over(const Facet& facet, const Point& p) noexcept {
  return std::ranges::all_of(facet.edges,
                             [&](const Edge& edge) { return edge.plane.normal.dot(p) < edge.plane.offset; });
}

bool GodObject::is_in_the_way(const Facet& facet, const Segment& path, double until, Obstacle& found) const noexcept {
  double height_m = facet.plane.normal.dot(path.from_m) - facet.plane.offset;
  const double side = two_sided_ && height_m < 0 ? -1 : 1;
  const double rate_m = side * facet.plane.normal.dot(path.way_m);
  height_m = side * height_m - clearance_m_;
  if (!(rate_m < 0) || height_m < -kBehindSkins * skin_m_ ||
      height_m + until * rate_m >= -kRisingBelowSkins * skin_m_) {
    return false;
  }
  double enter = 0;
  double leave = until;
  double below_m = skin_m_;
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
  if (enter > leave || height_m + enter * rate_m < -kBehindSkins * skin_m_) return false;
  if (height_m + leave * rate_m >= -below_m) return false;
  // So little above, rounding decides where a flat path meets the plane: here.
  const double meets = height_m > kOnSkins * skin_m_ ? height_m / -rate_m : 0;
  found = {{side * facet.plane.normal, height_m}, std::max(enter, meets), &facet};
  return true;
}

}  // namespace forcebound::scene
