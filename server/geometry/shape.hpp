#pragma once

#include <memory>

#include "forcebound/server/geometry/point.hpp"

namespace forcebound::server {

/// How a point lies to a surface.
struct SurfacePoint {
  Point normal;                ///< unit, out of the surface where it is nearest; meaningless where there is no contact
  double penetration_m = 0;    ///< > 0: that deep inside what is filled
  bool normal_is_old = false;  ///< no direction is nearest (the centre of a sphere): `normal` is the one given
};

/// What an object fills.
///
/// Real time: `nearest` is noexcept, allocates nothing and takes bounded time. Immutable.
class Shape {
 public:
  virtual ~Shape() = default;

  /// @param last_normal unit; the answer where the point itself gives none.
  [[nodiscard]] virtual SurfacePoint nearest(const Point& position_m, const Point& last_normal) const noexcept = 0;
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

}  // namespace forcebound::server
