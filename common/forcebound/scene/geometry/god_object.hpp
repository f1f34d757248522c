#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "forcebound/scene/geometry/bvh.hpp"
#include "forcebound/scene/geometry/facets.hpp"
#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {

namespace god_object {
class Search;
}  // namespace god_object

/// The god object's position for one client: flat bytes; all zeros is a new session without contact.
struct Proxy {
  double x_m;  // in the mesh's own frame
  double y_m;
  double z_m;
  std::uint64_t placed;  // 0: not placed yet
  double goal_x_m;       // the last goal
  double goal_y_m;
  double goal_z_m;
};

/// Both in the mesh's own frame.
[[nodiscard]] Proxy proxy_at(const Point& at_m, const Point& goal_m) noexcept;

struct GodObjectOptions {
  bool two_sided = false;  ///< contact from behind the triangles as well; else only from where their normals point
};

/// The god object (proxy) of a point that touches a mesh [Zilles and Salisbury, "A Constraint-based God-object Method
/// for Haptic Display", IROS 1995]: it follows the point, its goal, but stays outside of the mesh, as near to the goal
/// as the triangles allow. It remembers from which side the point came in, so that thin walls hold.
///
/// The god object goes straight to its goal until a triangle is in its way. Then it goes on to
///
///     argmin |x - goal|^2   subject to   n_i . (x - a_i) >= 0   for at most three planes i [eq. 1 to 4 there],
///
/// through the next triangle in its way and so on, until no nearer point can be reached. Where the paper finds the
/// planes by Lagrange multipliers once for each motion, ours are found anew at every position of the god object,
/// because the plane of a triangle that it has left no longer holds it; so it also follows a curved surface within one
/// motion. Where it comes to rest and the free space about it is not convex, as at the vertex of a saddle, it looks for
/// a triangle there that leads nearer to the goal: so it rests only where no triangle about it does.
///
/// At the end of a ridge the god object loses its hold, and the next resting place may be far away. Going there at once
/// would make the force jump, so one motion moves the god object no further than
///
///     4 |goal - goal before| + |goal - x| / 8 + (size of the mesh) / 1024,
///
/// and the next motions continue, even if the goal stays where it is.
///
/// Felt from both sides, a surface holds the god object on the side from which it came, whichever way the normals
/// point: it changes sides round a rim only. It keeps 2^-36 (1.5e-11) of the mesh's size away from the triangles,
/// farther than any of them holds beyond its edges and corners, so that none is felt through another one: a device that
/// slides over a convex edge is let go there. Where a way over the triangles about a vertex would go through one of
/// them by this distance, it is not taken, and the god object may rest at the vertex though a triangle leads nearer.
///
/// Numerics: all is computed in the mesh's own frame. A point is on a plane if within a `skin` of 2^-40 (1e-12) of the
/// mesh's size, and on a triangle if within four skins of its edges, so that rounding opens no gap and makes no step. A
/// path that leaves a triangle over an edge no deeper than the skin has not met it, if the surface continues there
/// level or downwards: coplanar triangles, whose computed normals differ by rounding, act as one plane.
///
/// Real time: `follow` is noexcept, allocates nothing, and makes at most kQueriesMost searches in the tree.
class GodObject {
 public:
  static constexpr int kQueriesMost = 64;

  explicit GodObject(std::shared_ptr<const TriangleMesh> mesh, const GodObjectOptions& options = {});
  explicit GodObject(Bvh tree, const GodObjectOptions& options = {});

  /// The surface that holds the god object back from `goal_m` (in the scene's frame): `normal` from the goal to the god
  /// object, `penetration_m` their distance; 0 without contact. The first call puts the god object at the goal, even
  /// inside. A goal that is not finite changes nothing and has no contact; one further away than 1e12 sizes of the mesh
  /// resets the god object.
  SurfacePoint follow(const Point& goal_m, Proxy& state) const noexcept;

  [[nodiscard]] const Bvh& bvh() const noexcept { return facets_.bvh(); }
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return facets_.memory_bytes(); }

 private:
  /// The god object's position, and how far it may still go.
  struct Walk {
    Point at_m;
    double left_m;

    /// Whether it may go that far.
    [[nodiscard]] bool go(const Point& way_m, double share) noexcept {
      const double length_m = way_m.norm();
      const bool arrives = share * length_m <= left_m;
      if (!arrives) share = left_m / length_m;
      at_m += share * way_m;
      left_m -= share * length_m;
      return arrives;
    }
  };

  [[nodiscard]] bool approach(Point& proxy, const Point& goal) const noexcept;
  [[nodiscard]] Point settle(Walk walk, const Point& goal, Point& last_normal) const noexcept;
  [[nodiscard]] bool step_around(Walk& walk, const Point& goal, god_object::Search& search) const noexcept;

  Facets facets_;
};

}  // namespace forcebound::scene
