#pragma once

#include <cstddef>
#include <new>

#include "forcebound/scene/geometry/surface_point.hpp"

namespace forcebound::scene {

class Shape;

/// Nearer to a shape's skeleton than this share of its size, a direction is rounding error.
inline constexpr double kRounding = 1e-12;

/// The last valid direction, for the places where a shape has none: the centre of a sphere, the axis of a cylinder. All
/// zeros at first, which stands for x.
struct LastNormal {
  double x;
  double y;
  double z;

  [[nodiscard]] static LastNormal& in(std::byte* state) noexcept {
    return *std::launder(reinterpret_cast<LastNormal*>(state));
  }

  /// `out` from the nearest point of the surface's skeleton, which is `distance_m` away; `penetration_m` is passed on.
  /// Nearer than `least_m` a direction is rounding error.
  SurfacePoint along(const Point& out, double distance_m, double least_m, double penetration_m) noexcept {
    if (!(distance_m > least_m)) return {get(), penetration_m, true};
    return {keep(out / distance_m), penetration_m};
  }

  Point keep(const Point& normal) noexcept {
    x = normal.x();
    y = normal.y();
    z = normal.z();
    return normal;
  }

  /// The last direction, turned perpendicular to the unit vector `axis`: any such is nearest where an axis is the
  /// skeleton. Lies in the plane of the first two axes if `axis` does.
  [[nodiscard]] Point get_across(const Point& axis) const noexcept {
    const Point last = get();
    const Point across = last - last.dot(axis) * axis;
    // What is left of a direction along the axis is rounding.
    if (const double length = across.norm(); length > 1e-6) return across / length;
    const Point in_plane(-axis.y(), axis.x(), 0);
    return in_plane.isZero(0) ? Point::UnitX() : in_plane.stableNormalized();
  }

  [[nodiscard]] Point get() const noexcept { return x == 0 && y == 0 && z == 0 ? Point::UnitX() : Point(x, y, z); }
};

/// Shape::nearest of one whose fresh state is a LastNormal's, or that has none, as if asked for the first time. Real
/// time.
[[nodiscard]] SurfacePoint nearest_at_first(const Shape& shape, const Point& at_m) noexcept;

}  // namespace forcebound::scene
