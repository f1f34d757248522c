#pragma once

#include <span>
#include <vector>

#include "forcebound/scene/geometry/point.hpp"
#include "forcebound/scene/geometry/shape.hpp"
#include "forcebound/scene/geometry/triangle_mesh.hpp"

namespace forcebound::scene {

/// A point with which a tool touches: the middle of a ball, of radius 0 a point of its surface.
struct ToolPoint {
  Point at_m = Point::Zero();  ///< from the tool's tip, in the handle's axes
  double radius_m = 0;

  friend bool operator==(const ToolPoint&, const ToolPoint&) = default;
};

/// More than these are refused before any memory is spent.
inline constexpr std::size_t kToolPointsMost = 10'000;
inline constexpr std::size_t kToolTrianglesMost = 250'000;

/// No point of a tool for a hand is further from its tip.
inline constexpr double kToolReachMost_m = 0.5;

/// The points of one part of a tool, no further apart along its surface than `spacing_m`.
///
///     ball      its middle alone, with its radius: exact against whatever is nearest to that
///     capsule   points of its axis, each with its radius r: with h between them, too small by r - sqrt(r^2 - h^2 / 4)
///     box       a grid on each face, with its edges and corners
///     cylinder  rings on the side and on both ends, with their middles
///     mesh      corners, edges and a grid on each triangle, none nearer to another one than half the spacing
///
/// @param kind name of a registered shape: "sphere", "capsule", "box", "cylinder" or "mesh"
/// @param geometry of a mesh: its triangles
/// @throws std::invalid_argument for another shape, for more points than kToolPointsMost, and of a mesh that is open,
/// has no volume or more triangles than kToolTrianglesMost
[[nodiscard]] std::vector<ToolPoint> points_of_part(std::string_view kind, const config::Values& values,
                                                    const ShapeGeometry& geometry, double spacing_m);

/// The shapes of `points_of_part`.
[[nodiscard]] std::span<const std::string_view> tool_part_kinds() noexcept;

}  // namespace forcebound::scene
