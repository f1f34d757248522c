#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "forcebound/scene/geometry/point.hpp"
#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {

/// A convex part of a tool, from its tip in the handle's axes.
struct ToolPart {
  enum class Kind : std::uint8_t { capsule, cylinder, box };  // of a ball both ends are its middle

  Kind kind = Kind::capsule;
  Point from_m = Point::Zero();  ///< of a box its least corner
  Point to_m = Point::Zero();    ///< of a box its largest one
  double radius_m = 0;

  friend bool operator==(const ToolPart&, const ToolPart&) = default;
};

/// The part of a registered shape, as `points_of_part` names them; none: it is not convex.
[[nodiscard]] std::optional<ToolPart> convex_part(std::string_view kind, const config::Values& values);

/// More than these are refused.
inline constexpr std::size_t kToolPartsMost = 64;

/// What a part's distance is, of one that is smaller by `less_m` on all sides; of a capsule, of itself.
[[nodiscard]] std::unique_ptr<Shape> make_solid(const ToolPart& part, double less_m);

/// A sharp edge of a solid, or a line of which the solid is what is near it.
struct Edge {
  enum class Kind : std::uint8_t {
    segment,  ///< at(t) = middle + t x, -1 <= t <= 1
    side,     ///< likewise, the axis of a cylinder: its surface is meant where it is nearest across the axis
    circle,   ///< at(t) = middle + cos(t) x + sin(t) y
  };

  Kind kind = Kind::segment;
  Point middle_m = Point::Zero();
  Point x_m = Point::Zero();
  Point y_m = Point::Zero();
  double radius_m = 0;  ///< of what is about it

  [[nodiscard]] static Edge between(const Point& from_m, const Point& to_m, double radius_m = 0,
                                    Kind kind = Kind::segment) {
    return {.kind = kind, .middle_m = 0.5 * (from_m + to_m), .x_m = 0.5 * (to_m - from_m), .radius_m = radius_m};
  }
  [[nodiscard]] Edge moved(const Eigen::Matrix3d& rotation, const Point& to_m) const noexcept {
    Edge edge = *this;
    edge.middle_m = to_m;
    edge.x_m = rotation * x_m;
    edge.y_m = rotation * y_m;
    return edge;
  }
  /// No point of the edge is further from the middle [m].
  [[nodiscard]] double reach_m() const noexcept { return x_m.norm(); }
};

/// What of a solid must be asked about another one, so that both are apart where all of it is.
struct SolidEdges {
  std::vector<Edge> corners{};  ///< of a box
  std::vector<Edge> edges{};    ///< of a box; of a sphere and capsule their axis
  std::vector<Edge> rims{};     ///< of a cylinder, and its side
};

/// @param rounded_m both are that much smaller, and have a rim of balls of that radius
[[nodiscard]] SolidEdges edges_of_box(const Point& center_m, const Point& size_m, double rounded_m = 0);
[[nodiscard]] SolidEdges edges_of_cylinder(const Point& from_m, const Point& to_m, double radius_m,
                                           double rounded_m = 0);

}  // namespace forcebound::scene
