#pragma once

#include "forcebound/server/geometry/shape.hpp"

namespace forcebound::server {

/// The last direction that was valid, for the places where a shape has none: the centre of a sphere, the axis of a
/// cylinder. All zeros at first, which stands for x.
struct LastNormal {
  double x;
  double y;
  double z;

  [[nodiscard]] static LastNormal& in(std::byte* state) noexcept {
    return *std::launder(reinterpret_cast<LastNormal*>(state));
  }

  /// `out` from the nearest point of the surface's skeleton, which is `distance_m` away; `penetration_m` as it is.
  /// Nearer than `least_m` a direction is made of rounding errors.
  SurfacePoint along(const Point& out, double distance_m, double least_m, double penetration_m) noexcept {
    if (!(distance_m > least_m)) return {get(), penetration_m, true};
    const Point normal = out / distance_m;
    x = normal.x();
    y = normal.y();
    z = normal.z();
    return {normal, penetration_m};
  }

  [[nodiscard]] Point get() const noexcept { return x == 0 && y == 0 && z == 0 ? Point::UnitX() : Point(x, y, z); }
};

}  // namespace forcebound::server
