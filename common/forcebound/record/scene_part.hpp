#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace forcebound::record {

/// A part of a scene as pictures show it, in the scene's frame, lengths in metres.
struct ScenePart {
  enum class Kind : std::uint8_t { plane, box, sphere, cavity, cylinder, capsule, mesh };

  std::string name;
  Kind kind = Kind::mesh;
  bool moves = false;  ///< told is where it begins
  /// The middle; of a plane a point of it, whose normal is z of its own frame.
  Eigen::Vector3d place_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  /// Of a box its edges; of spheres and cavities diameters; of cylinders diameters and length along z, of capsules that
  /// without the caps.
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
  /// Of a mesh, in the scene's frame.
  std::vector<Eigen::Vector3d> vertices_m{};
  std::vector<std::array<std::uint32_t, 3>> triangles{};
};

}  // namespace forcebound::record
