#include "forcebound/scene/geometry/mesh_placement.hpp"

#include <cmath>
#include <numbers>

#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {
namespace {

struct Turn {
  double cosine;
  double sine;
};

Turn turn_by(double angle_deg) {
  const double quarters = std::remainder(angle_deg / 90, 4);
  if (quarters == std::round(quarters)) {
    const bool odd = std::abs(quarters) == 1;
    return {odd ? 0.0 : quarters == 0 ? 1.0 : -1.0, odd ? quarters : 0.0};
  }
  const double angle = angle_deg * std::numbers::pi / 180;
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

bool MeshPlacement::valid() const noexcept {
  return scale > 0 && std::isfinite(scale) && offset_m.allFinite() && rotation.allFinite();
}

Eigen::Matrix3d rotation_from_degrees(const Point& roll_pitch_yaw_deg) {
  const Turn roll = turn_by(roll_pitch_yaw_deg.x());
  const Turn pitch = turn_by(roll_pitch_yaw_deg.y());
  const Turn yaw = turn_by(roll_pitch_yaw_deg.z());
  Eigen::Matrix3d about_x;
  Eigen::Matrix3d about_y;
  Eigen::Matrix3d about_z;
  about_x << 1, 0, 0, 0, roll.cosine, -roll.sine, 0, roll.sine, roll.cosine;
  about_y << pitch.cosine, 0, pitch.sine, 0, 1, 0, -pitch.sine, 0, pitch.cosine;
  about_z << yaw.cosine, -yaw.sine, 0, yaw.sine, yaw.cosine, 0, 0, 0, 1;
  return about_z * about_y * about_x;
}

config::PointParameter rotation_parameter(std::string_view meaning) {
  return {.key = "rotation_deg", .meaning = meaning, .preset = Point::Zero(), .accepted = "a list of 3 numbers"};
}

std::vector<config::Parameter> placement_parameters() {
  return {config::positive_number("scale", "metres per unit of the file", 1e9, 1),
          rotation_parameter("roll, pitch and yaw: turned about the scene's x, then y, then z axis, after `scale`"),
          place_parameter("offset_m", "added to every vertex, after `rotation_deg`", Point::Zero())};
}

MeshPlacement placement_of(const config::Values& values) {
  return {.scale = values.number("scale"),
          .offset_m = values.point("offset_m"),
          .rotation = rotation_from_degrees(values.point("rotation_deg"))};
}

}  // namespace forcebound::scene
