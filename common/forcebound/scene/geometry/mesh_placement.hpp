#pragma once

#include <vector>

#include "forcebound/config/parameter.hpp"
#include "forcebound/scene/geometry/point.hpp"

namespace forcebound::scene {

/// The placement of a file's mesh in the scene: vertex v lies at rotation * (scale * v) + offset_m.
struct MeshPlacement {
  double scale = 1;
  Point offset_m = Point::Zero();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();

  [[nodiscard]] bool turns() const noexcept { return rotation != Eigen::Matrix3d::Identity(); }

  /// Whether all numbers are finite and the scale is > 0.
  [[nodiscard]] bool valid() const noexcept;
};

/// Turned about the scene's fixed x, then y, then z axis, right-handed: Rz(yaw) Ry(pitch) Rx(roll). Quarter turns are
/// exact, so that edges along an axis stay so.
[[nodiscard]] Eigen::Matrix3d rotation_from_degrees(const Point& roll_pitch_yaw_deg);

/// The key `rotation_deg`: [roll, pitch, yaw].
[[nodiscard]] config::PointParameter rotation_parameter(std::string_view meaning);

/// Keys that place a file's mesh or tissue: `scale`, then `rotation_deg`, then `offset_m`.
[[nodiscard]] std::vector<config::Parameter> placement_parameters();

/// The placement from the values of these keys.
[[nodiscard]] MeshPlacement placement_of(const config::Values& values);

}  // namespace forcebound::scene
