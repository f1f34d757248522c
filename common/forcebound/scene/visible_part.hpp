#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::scene {

/// A part of a dynamic model as a picture shows it: a surface that deforms, or a solid that moves.
struct VisiblePart {
  enum class Kind : std::uint8_t { surface, half_space, box, sphere, capsule, cylinder, mesh };

  std::string name;
  Kind kind = Kind::surface;
  /// Of a solid in its own frame: a box's half edges; else the radius, and of capsule and cylinder half of their length
  /// along z.
  Point half_m = Point::Zero();
  /// Where it begins: the middle, of a half-space a point of its plane, whose normal is z of its own frame.
  Point place_m = Point::Zero();
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  /// Of a surface, at rest in the scene's frame; of a mesh in its own.
  std::vector<Point> vertices_m{};
  std::vector<std::array<std::uint32_t, 3>> triangles{};
};

/// Numbers that tell where a vertex of a surface is: x, y, z; and a solid: x, y, z, then its quaternion w, x, y, z.
inline constexpr std::size_t kNumbersOfVertex = 3;
inline constexpr std::size_t kNumbersOfSolid = 7;

}  // namespace forcebound::scene
