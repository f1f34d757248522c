#include "forcebound/server/follower/target_limiter.hpp"

#include <cmath>
#include <numbers>

#include "forcebound/local_model/no_longer_than.hpp"

namespace forcebound::server {
namespace {

// Cut-off of the low-pass: motions that come every few milliseconds are joined, a hand's motion passes.
constexpr double kCutoff_rad_per_s = 150;
constexpr double kVelocityCutoff_rad_per_s = 60;

}  // namespace

const ToolTarget& TargetLimiter::move_to(const ToolPose& wanted, double elapsed_s) noexcept {
  if (!(elapsed_s > 0)) return target_;
  const double share = 1 - std::exp(-kCutoff_rad_per_s * elapsed_s);
  const double velocity_share = 1 - std::exp(-kVelocityCutoff_rad_per_s * elapsed_s);
  const Eigen::Vector3d step = local_model::no_longer_than<Eigen::Vector3d>(
      share * (wanted.position - target_.pose.position), speed_most_ * elapsed_s);
  target_.pose.position += step;
  target_.velocity += velocity_share * (step / elapsed_s - target_.velocity);

  const Eigen::AngleAxisd off(wanted.orientation * target_.pose.orientation.conjugate());
  const double angle = std::remainder(off.angle(), 2 * std::numbers::pi);
  const Eigen::Vector3d turn =
      local_model::no_longer_than<Eigen::Vector3d>(share * angle * off.axis(), turn_most_ * elapsed_s);
  const double turned = turn.norm();
  if (turned > 0) {
    const Eigen::Quaterniond by(Eigen::AngleAxisd(turned, turn / turned));
    target_.pose.orientation = (by * target_.pose.orientation).normalized();
  }
  target_.turn += velocity_share * (turn / elapsed_s - target_.turn);
  return target_;
}

}  // namespace forcebound::server
