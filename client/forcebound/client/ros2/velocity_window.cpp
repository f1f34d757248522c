#include "forcebound/client/ros2/velocity_window.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace forcebound::ros2 {
namespace {

Eigen::Quaterniond quaternion_of(const control::Handle::Orientation& of) noexcept {
  return {of[0], of[1], of[2], of[3]};
}

/// From one orientation to another [rad].
Eigen::Vector3d turn(const control::Handle::Orientation& from, const control::Handle::Orientation& to) noexcept {
  const Eigen::AngleAxisd turned(quaternion_of(to) * quaternion_of(from).conjugate());
  return turned.angle() * turned.axis();
}

}  // namespace

std::optional<Velocity> VelocityWindow::update(const StateSample& sample) noexcept {
  if (!sample.position.allFinite() || sample.position.rows() == 0) {
    samples_ = {};
    return std::nullopt;
  }
  samples_.push(sample);
  const StateSample& before = samples_.at(std::min(samples_.later_than(sample.time - kLong), samples_.size() - 1));
  const double elapsed_s = time::to_seconds(sample.time - before.time);
  if (!(elapsed_s > 0) || before.position.rows() != sample.position.rows()) return std::nullopt;
  Velocity velocity;
  const Eigen::Index rows = std::min<Eigen::Index>(sample.position.rows(), 3);
  velocity.linear_m_per_s.head(rows) = (sample.position - before.position).head(rows) / elapsed_s;
  if (before.handle.orientation && sample.handle.orientation) {
    velocity.angular_rad_per_s = turn(*before.handle.orientation, *sample.handle.orientation) / elapsed_s;
  }
  return velocity;
}

}  // namespace forcebound::ros2
