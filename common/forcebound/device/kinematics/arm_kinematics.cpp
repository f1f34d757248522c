#include "forcebound/device/kinematics/arm_kinematics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace forcebound::device {

Vector ArmKinematics::position(const Vector& joint) const noexcept {
  const auto& g = geometry_;
  const double reach = g.upper_length_m * std::cos(joint[1]) + g.fore_length_m * std::sin(joint[2]);
  const double height = g.upper_length_m * std::sin(joint[1]) - g.fore_length_m * std::cos(joint[2]);
  Vector position(3);
  position << reach * std::sin(joint[0]), g.origin_reach_m - reach * std::cos(joint[0]), height - g.origin_height_m;
  return position;
}

Matrix ArmKinematics::jacobian(const Vector& joint) const noexcept {
  const double sin_yaw = std::sin(joint[0]);
  const double cos_yaw = std::cos(joint[0]);
  const double upper_reach = geometry_.upper_length_m * std::cos(joint[1]);
  const double upper_height = geometry_.upper_length_m * std::sin(joint[1]);
  const double fore_reach = geometry_.fore_length_m * std::sin(joint[2]);
  const double fore_height = geometry_.fore_length_m * std::cos(joint[2]);
  const double reach = upper_reach + fore_reach;
  Matrix jacobian(3, 3);
  jacobian << reach * cos_yaw, -upper_height * sin_yaw, fore_height * sin_yaw,  //
      reach * sin_yaw, upper_height * cos_yaw, -fore_height * cos_yaw,          //
      0, upper_reach, fore_reach;
  return jacobian;
}

Vector ArmKinematics::joints_at(const Vector& position) const noexcept {
  const double upper = geometry_.upper_length_m;
  const double fore = geometry_.fore_length_m;
  const double forward = geometry_.origin_reach_m - position[1];
  const double height = position[2] + geometry_.origin_height_m;
  const double reach = std::hypot(position[0], forward);
  const double distance = std::clamp(std::hypot(reach, height), std::abs(upper - fore) + 1e-9, upper + fore);
  // Law of cosines in the arm's plane, elbow up. The fore link points at elbow - 90 degrees.
  const double at_shoulder = (upper * upper + distance * distance - fore * fore) / (2 * upper * distance);
  const double at_elbow = (upper * upper + fore * fore - distance * distance) / (2 * upper * fore);
  const double shoulder = std::atan2(height, reach) + std::acos(std::clamp(at_shoulder, -1.0, 1.0));
  const double elbow =
      shoulder - (std::numbers::pi - std::acos(std::clamp(at_elbow, -1.0, 1.0))) + 0.5 * std::numbers::pi;
  Vector joint(3);
  joint << std::atan2(position[0], forward), shoulder, elbow;
  return joint;
}

}  // namespace forcebound::device
