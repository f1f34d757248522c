#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <memory>

#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::scene {

/// How a point lies to a surface.
struct SurfacePoint {
  Point normal = Point::UnitX();  ///< unit, out of the surface where it is nearest
  double penetration_m = 0;       ///< > 0: that deep inside what is filled; < 0: no contact, that far outside
  bool normal_is_old = false;     ///< no direction is nearest (the centre of a sphere): the last one that was valid
};

/// What the plan and people need to know of a shape.
struct ShapeFacts {
  std::size_t state_bytes = 0;         ///< kept for each session, zeros at first
  std::size_t memory_bytes = 0;        ///< of the shape itself, shared by all sessions
  double cost_ns = 5;                  ///< for one motion, roughly, on a machine of today
  Point on_surface_m = Point::Zero();  ///< some point of the surface, to try it at
  Eigen::AlignedBox3d bounds_m{};      ///< what of the surface is not infinite lies in it; empty: all of it may be
};

/// The box of so much to each side of a point.
[[nodiscard]] inline Eigen::AlignedBox3d bounds_about(const Point& middle_m, const Point& half_m) {
  return {Point(middle_m - half_m), Point(middle_m + half_m)};
}

/// What an object fills.
///
/// Real time: `nearest` is noexcept, allocates nothing and takes bounded time. Immutable; what it remembers of a client
/// lies in `state`, ShapeFacts::state_bytes of it, aligned for a double.
class Shape {
 public:
  virtual ~Shape() = default;

  [[nodiscard]] virtual SurfacePoint nearest(const Point& position_m, std::byte* state) const noexcept = 0;

  [[nodiscard]] virtual ShapeFacts facts() const { return {}; }
};

/// Everything below the plane through a point; `normal` (any length but zero) points out of what is filled.
std::unique_ptr<Shape> make_half_space(const Point& through_m, const Point& normal);

/// A filled ball; on two axes a disc.
std::unique_ptr<Shape> make_sphere(const Point& center_m, double radius_m);

/// The inside of a hollow ball (on two axes: circle): everything outside of the radius is filled.
std::unique_ptr<Shape> make_cavity(const Point& center_m, double radius_m);

/// A filled block along the axes. An axis of infinite size has no faces. Where several faces are equally near, the
/// first axis counts, and on it the positive side.
std::unique_ptr<Shape> make_box(const Point& center_m, const Point& size_m);

}  // namespace forcebound::scene
