#include "forcebound/scene/geometry/god_object.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "forcebound/scene/geometry/internal/god_object_constraints.hpp"
#include "forcebound/scene/geometry/internal/god_object_fan.hpp"
#include "forcebound/scene/geometry/internal/god_object_search.hpp"
#include "forcebound/scene/geometry/internal/skins.hpp"

namespace forcebound::scene {
namespace {

constexpr double kFarSizes = 1e12;
// Limits of one motion of the god object: a multiple of the goal's way, a share of its distance from the goal, and a
// share of the mesh's size.
constexpr double kStretch = 4;
constexpr double kShareOfDepth = 0x1p-3;
constexpr double kShareOfSize = 0x1p-10;

}  // namespace

Proxy proxy_at(const Point& at_m, const Point& goal_m) noexcept {
  return {at_m.x(), at_m.y(), at_m.z(), 1, goal_m.x(), goal_m.y(), goal_m.z()};
}

GodObject::GodObject(std::shared_ptr<const TriangleMesh> mesh, const GodObjectOptions& options)
    : GodObject(Bvh(std::move(mesh)), options) {}

GodObject::GodObject(Bvh tree, const GodObjectOptions& options) : facets_(std::move(tree), options.two_sided) {}

SurfacePoint GodObject::follow(const Point& goal_m, Proxy& state) const noexcept {
  const Point goal = goal_m - facets_.bvh().mesh().origin_m();
  if (!goal.allFinite()) return {};
  if (goal.cwiseAbs().maxCoeff() > kFarSizes * facets_.bvh().mesh().size_m()) {
    state = {};
    return {};
  }
  if (state.placed == 0) state = proxy_at(goal, goal);
  Point proxy(state.x_m, state.y_m, state.z_m);
  const Point before(state.goal_x_m, state.goal_y_m, state.goal_z_m);
  const double most_m = kStretch * (goal - before).norm() + kShareOfDepth * (goal - proxy).norm() +
                        kShareOfSize * facets_.bvh().mesh().size_m();
  Point normal = Point::UnitX();
  proxy = approach(proxy, goal) ? settle({proxy, most_m}, goal, normal) : goal;
  state = proxy_at(proxy, goal);
  const Point out = proxy - goal;
  const double penetration_m = out.norm();
  if (penetration_m > kShallowSkins * facets_.skin_m()) normal = out / penetration_m;
  return {.normal = normal, .penetration_m = penetration_m};
}

/// Moves a god object that is far from the mesh along its way to near the mesh, so that shares of the rest of its way
/// are exact to less than the skin. False if its way does not come near.
bool GodObject::approach(Point& proxy, const Point& goal) const noexcept {
  const Point near = facets_.bvh().mesh().box_m().max().array() + facets_.bvh().mesh().size_m();
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
  god_object::Constraints held(facets_);
  god_object::Search search(facets_, kQueriesMost);
  Point way = goal - walk.at_m;
  while (!search.is_over()) {
    const double length_m = way.norm();
    bool rests = length_m <= kOnSkins * facets_.skin_m();
    if (!rests) {
      Facets::Obstacle obstacle;
      if (held.size() > 0) search.gather_about({walk.at_m, way});
      const bool blocked = search.first_obstacle({walk.at_m, way}, obstacle);
      const bool stands = blocked && obstacle.share * length_m <= facets_.skin_m();
      if (blocked) last_normal = obstacle.constraint.normal;
      if (!stands && !walk.go(way, blocked ? obstacle.share : 1)) return walk.at_m;
      if (!blocked && held.size() == 0) return goal;
      const bool holds = held.follow(walk.at_m);
      if (blocked && (holds || stands)) {
        way = held.add(facets_.seen_from(walk.at_m, obstacle.constraint), goal - walk.at_m);
        continue;
      }
      rests = !blocked && (holds || length_m <= facets_.skin_m());
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
bool GodObject::step_around(Walk& walk, const Point& goal, god_object::Search& search) const noexcept {
  const auto is_open = [&](const Point& way, std::span<const std::uint32_t> without, double& share) {
    Facets::Obstacle obstacle;
    const bool blocked = search.first_obstacle({walk.at_m, way}, obstacle, without);
    share = blocked ? obstacle.share : 1;
    return share * way.norm() > facets_.skin_m();
  };
  double share = 0;
  const Point straight = goal - walk.at_m;
  if (is_open(straight, {}, share)) return walk.go(straight, share);
  god_object::Fan about(facets_, search, walk.at_m, goal);
  for (std::size_t i = 0; i < about.steps().size(); ++i) {
    const auto around = about.around(i);
    if (around && is_open(about.steps()[i].way, *around, share)) return walk.go(about.steps()[i].way, share);
  }
  return false;
}

}  // namespace forcebound::scene
