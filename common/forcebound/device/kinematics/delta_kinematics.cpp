#include "forcebound/device/kinematics/delta_kinematics.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "forcebound/device/kinematics/bounded_solve.hpp"
#include "forcebound/device/kinematics/towards_reach.hpp"

namespace forcebound::device {
namespace {

constexpr double kApart_rad = 2 * std::numbers::pi / 3;

}  // namespace

DeltaKinematics::DeltaKinematics(const DeltaGeometry& geometry) : geometry_(geometry) {
  for (std::size_t i = 0; i < kArms; ++i) {
    const double angle = geometry.first_arm_rad + static_cast<double>(i) * kApart_rad;
    outward_[i] = {std::cos(angle), std::sin(angle), 0};
    across_[i] = {-std::sin(angle), std::cos(angle), 0};
  }
}

DeltaKinematics::Centres DeltaKinematics::centres(const Vector& joint) const noexcept {
  const DeltaGeometry& g = geometry_;
  Centres centres;
  for (std::size_t i = 0; i < kArms; ++i) {
    const double angle = joint[static_cast<Eigen::Index>(i)];
    const double radius = g.base_radius_m - g.platform_radius_m + g.upper_arm_length_m * std::cos(angle);
    centres[i] = radius * outward_[i] + g.side_offset_m * across_[i];
    centres[i].z() = g.upper_arm_length_m * std::sin(angle);
  }
  return centres;
}

DeltaKinematics::Point DeltaKinematics::tip(const Centres& centres) const noexcept {
  const double forearm = geometry_.forearm_length_m;
  const Point a = centres[1] - centres[0];
  const Point b = centres[2] - centres[0];
  const Point across = a.cross(b);
  // Of three places in a line, or in one, no circle has a middle to speak of.
  constexpr double kAreaLeast = 1e-9;
  const bool round = across.norm() > kAreaLeast * forearm * forearm;
  const Point middle =
      round ? Point(centres[0] + (b.squaredNorm() * across.cross(a) + a.squaredNorm() * b.cross(across)) /
                                     (2 * across.squaredNorm()))
            : Point((centres[0] + centres[1] + centres[2]) / kArms);
  // The same side for arms that are folded inwards, beyond the base's axis, where the centres' order is the other way.
  const Point normal = round ? Point(std::copysign(1.0, across.z()) * across.normalized()) : Point::UnitZ();
  const double rest = forearm * forearm - (centres[0] - middle).squaredNorm();
  return middle + std::sqrt(std::max(0.0, rest)) * normal;
}

Vector DeltaKinematics::position(const Vector& joint) const noexcept {
  const Point at = tip(centres(joint));
  Vector position(kArms);
  position << at.x(), geometry_.origin_reach_m - at.z(), at.y();
  return position;
}

Matrix DeltaKinematics::jacobian(const Vector& joint) const noexcept {
  const Centres centre = centres(joint);
  const Point at = tip(centre);
  Eigen::Matrix3d forearms;
  Eigen::Vector3d drives;
  for (std::size_t i = 0; i < kArms; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    // No longer than 1 where nothing can be assembled either.
    const Point way = at - centre[i];
    const Point forearm = way / std::max(geometry_.forearm_length_m, way.norm());
    const Point turn = Point::UnitZ() * std::cos(joint[row]) - outward_[i] * std::sin(joint[row]);
    forearms.row(row) = forearm;
    drives[row] = geometry_.upper_arm_length_m * forearm.dot(turn);
  }
  const Matrix moved = bounded_solve(forearms, drives);
  Matrix jacobian(kArms, kArms);
  jacobian << moved.row(0), -moved.row(2), moved.row(1);
  return jacobian;
}

Vector DeltaKinematics::joints_of(const Point& tip) const noexcept {
  const DeltaGeometry& g = geometry_;
  const double upper = g.upper_arm_length_m;
  Vector joint(kArms);
  for (std::size_t i = 0; i < kArms; ++i) {
    const double out = tip.dot(outward_[i]) - (g.base_radius_m - g.platform_radius_m);
    const double beside = tip.dot(across_[i]) - g.side_offset_m;
    const double distance = std::hypot(out, tip.z());
    const double wanted =
        (distance * distance + beside * beside + upper * upper - g.forearm_length_m * g.forearm_length_m) / (2 * upper);
    const double share = distance > 0 ? std::clamp(wanted / distance, -1.0, 1.0) : 1.0;
    joint[static_cast<Eigen::Index>(i)] = std::atan2(tip.z(), out) - std::acos(share);
  }
  return joint;
}

Vector DeltaKinematics::joints_at(const Vector& position) const noexcept {
  const auto joints = [this](const Vector& place) {
    return joints_of({place[0], place[2], geometry_.origin_reach_m - place[1]});
  };
  constexpr double kRounding = 1e-9;
  const double size = geometry_.upper_arm_length_m + geometry_.forearm_length_m;
  const auto reaches = [&](const Vector& place) {
    return (this->position(joints(place)) - place).norm() <= kRounding * size;
  };
  return joints(towards_reach(position, reaches));
}

}  // namespace forcebound::device
