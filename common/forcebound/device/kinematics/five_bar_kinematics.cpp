#include "forcebound/device/kinematics/five_bar_kinematics.hpp"

#include <algorithm>
#include <cmath>

#include "forcebound/device/kinematics/bounded_solve.hpp"
#include "forcebound/device/kinematics/towards_reach.hpp"

namespace forcebound::device {
namespace {

// Elbows nearer to each other than this share of a distal link do not say which way is to the front.
constexpr double kElbowsApartLeast = 1e-9;

Eigen::Vector2d turned(const Eigen::Vector2d& v) { return {-v.y(), v.x()}; }

}  // namespace

FiveBarKinematics::Plane FiveBarKinematics::base(int side) const noexcept {
  return {(side - 0.5) * geometry_.base_distance_m, 0};
}

std::array<FiveBarKinematics::Plane, 2> FiveBarKinematics::elbows(const Vector& joint) const noexcept {
  const auto elbow = [&](int side) -> Plane {
    return base(side) + geometry_.proximal_length_m * Plane(std::cos(joint[side]), std::sin(joint[side]));
  };
  return {elbow(0), elbow(1)};
}

FiveBarKinematics::Plane FiveBarKinematics::tip(const std::array<Plane, 2>& elbows) const noexcept {
  const double distal = geometry_.distal_length_m;
  const Plane apart = elbows[1] - elbows[0];
  const double distance = apart.norm();
  const Plane front = distance > kElbowsApartLeast * distal ? Plane(turned(apart) / distance) : Plane(0, 1);
  const double height = std::sqrt(std::max(0.0, distal * distal - 0.25 * distance * distance));
  return 0.5 * (elbows[0] + elbows[1]) + height * front;
}

Vector FiveBarKinematics::position(const Vector& joint) const noexcept {
  const Plane at = tip(elbows(joint));
  Vector position(2);
  position << at.x(), geometry_.origin_reach_m - at.y();
  return position;
}

Matrix FiveBarKinematics::jacobian(const Vector& joint) const noexcept {
  const std::array<Plane, 2> elbow = elbows(joint);
  const Plane at = tip(elbow);
  Eigen::Matrix2d links;
  Eigen::Vector2d drives;
  for (int side = 0; side < 2; ++side) {
    // No longer than 1 where nothing can be assembled either.
    const Plane way = at - elbow[static_cast<std::size_t>(side)];
    const Plane link = way / std::max(geometry_.distal_length_m, way.norm());
    links.row(side) = link;
    drives[side] = geometry_.proximal_length_m * link.dot(Plane(-std::sin(joint[side]), std::cos(joint[side])));
  }
  Matrix jacobian = bounded_solve(links, drives);
  jacobian.row(1) *= -1;
  return jacobian;
}

Vector FiveBarKinematics::joints_at(const Vector& position) const noexcept {
  const double proximal = geometry_.proximal_length_m;
  const double distal = geometry_.distal_length_m;
  const auto to = [&](const Vector& place, int side) -> Plane {
    return Plane(place[0], geometry_.origin_reach_m - place[1]) - base(side);
  };
  const auto angle = [&](const Vector& place, int side) {
    const Plane way = to(place, side);
    const double distance = std::max(way.norm(), kElbowsApartLeast * proximal);
    const double cosine = (proximal * proximal + distance * distance - distal * distal) / (2 * proximal * distance);
    const double outward = std::acos(std::clamp(cosine, -1.0, 1.0));
    return std::atan2(way.y(), way.x()) + (side == 0 ? outward : -outward);
  };
  const auto joints = [&](const Vector& place) {
    Vector joint(2);
    joint << angle(place, 0), angle(place, 1);
    return joint;
  };
  constexpr double kRounding = 1e-9;
  const auto reaches = [&](const Vector& place) {
    return (this->position(joints(place)) - place).norm() <= kRounding * (proximal + distal);
  };
  return joints(towards_reach(position, reaches));
}

}  // namespace forcebound::device
