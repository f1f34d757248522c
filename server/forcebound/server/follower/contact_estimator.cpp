#include "forcebound/server/follower/contact_estimator.hpp"

#include <algorithm>
#include <cmath>

namespace forcebound::server {
namespace {

constexpr double kSliding_m_per_s = 3e-3;
constexpr double kFrictionMost = 1;
constexpr double kNoiseMost = 4;  // of its standard deviation
// A fresh estimate: how far the first stiffness and the offset may be off.
constexpr double kStiffnessShare = 3;
constexpr double kOffset_N = 3;
// Forgetting without news must not let the covariance grow for ever.
constexpr double kCovarianceMost = 1e12;

/// What is left of the force on the surroundings without friction along the tool's way, and without noise there, which
/// would tilt the normal if it counted on one side alone. All of it where that would be more than friction can be, or
/// push the tool on: it is another surface then, or a bent one.
Eigen::Vector3d without_friction(const Eigen::Vector3d& force_N, const Eigen::Vector3d& velocity,
                                 const Eigen::Vector3d& normal, double noise_N) noexcept {
  const Eigen::Vector3d along = velocity - velocity.dot(normal) * normal;
  const double speed = along.norm();
  if (speed < kSliding_m_per_s) return force_N;
  const Eigen::Vector3d way = along / speed;
  const double along_N = force_N.dot(way);
  const bool is_friction = along_N > -kNoiseMost * noise_N && along_N < -kFrictionMost * force_N.dot(normal);
  return is_friction ? Eigen::Vector3d(force_N - along_N * way) : force_N;
}

}  // namespace

const FeltSurface& ContactEstimator::update(Nanoseconds now, const Eigen::Vector3d& tool_m,
                                            const Eigen::Vector3d& velocity_m_per_s,
                                            const Eigen::Vector3d& force_N) noexcept {
  const double elapsed_s = std::max(0.0, time::to_seconds(now - last_));
  last_ = now;
  const bool was_touched = surface_.touched;
  surface_.touched = force_N.norm() > (was_touched ? settings_.leave_N : settings_.touch_N);
  if (!surface_.touched) {
    // It went through where the surface was: that is not there any more.
    const bool through = surface_.known && (surface_.place_m - tool_m).dot(surface_.normal) > settings_.another_m;
    if (through) surface_.known = false;
    if (surface_.known) place_plane(tool_m);
    return surface_;
  }
  const Eigen::Vector3d pressed =
      was_touched ? without_friction(force_N, velocity_m_per_s, surface_.normal, settings_.noise_N) : force_N;
  const double size = pressed.norm();
  if (!(size > 0)) return surface_;
  const Eigen::Vector3d seen = -pressed / size;
  // One sample that points elsewhere is noise, or friction that the velocity does not explain.
  const bool points_aside = seen.dot(surface_.normal) < std::cos(settings_.another_angle_rad);
  aside_ = points_aside ? aside_ + 1 : 0;
  const bool aside = aside_ >= settings_.another_samples;
  const bool away = !was_touched && std::abs((tool_m - surface_.place_m).dot(surface_.normal)) > settings_.another_m;
  if (!surface_.known || aside || away) {
    begin_contact(tool_m, seen);
  } else if (!points_aside) {
    const double share = 1 - std::exp(-elapsed_s / settings_.normal_s);
    surface_.normal = (surface_.normal + share * (seen - surface_.normal)).normalized();
  }
  const double normal_N = -force_N.dot(surface_.normal);
  learn((begin_m_ - tool_m).dot(surface_.normal), normal_N);
  place_plane(tool_m);
  const Eigen::Vector3d along = velocity_m_per_s - velocity_m_per_s.dot(surface_.normal) * surface_.normal;
  if (along.norm() > kSliding_m_per_s && normal_N > settings_.touch_N) {
    // With its sign: of a smooth surface noise alone has none on the average.
    const double seen_friction = std::clamp(force_N.dot(along.normalized()) / normal_N, -kFrictionMost, kFrictionMost);
    friction_ += (1 - std::exp(-elapsed_s / settings_.friction_s)) * (seen_friction - friction_);
    surface_.friction = std::max(0.0, friction_);
  }
  return surface_;
}

void ContactEstimator::begin_contact(const Eigen::Vector3d& tool_m, const Eigen::Vector3d& normal) noexcept {
  surface_ = {.known = true, .touched = true, .id = surface_.id + 1, .normal = normal};
  begin_m_ = tool_m;
  aside_ = 0;
  friction_ = 0;
  line_ = {settings_.stiffness_N_per_m_first, settings_.touch_N};
  const double stiffness = kStiffnessShare * settings_.stiffness_N_per_m_first;
  covariance_ = Eigen::Vector2d(stiffness * stiffness, kOffset_N * kOffset_N).asDiagonal();
}

/// f_n = K z + a, by recursive least squares.
void ContactEstimator::learn(double depth_m, double normal_N) noexcept {
  const Eigen::Vector2d regressor(depth_m, 1);
  const double noise = settings_.noise_N * settings_.noise_N;
  const Eigen::Vector2d spread = covariance_ * regressor;
  const Eigen::Vector2d gain = spread / (settings_.forgetting * noise + regressor.dot(spread));
  line_ += gain * (normal_N - line_.dot(regressor));
  line_[0] = std::clamp(line_[0], settings_.stiffness_N_per_m_least, settings_.stiffness_N_per_m_most);
  const Eigen::Matrix2d left = covariance_ - gain * spread.transpose();
  const Eigen::Matrix2d forgot = left / settings_.forgetting;
  // Without a change of depth there is nothing new to forget the old for.
  covariance_ = forgot.trace() < kCovarianceMost && forgot(0, 0) < covariance_(0, 0) ? forgot : left;
  surface_.stiffness_N_per_m = line_[0];
  surface_.certainty = std::clamp(1 - std::sqrt(std::max(0.0, covariance_(0, 0))) / line_[0], 0.0, 1.0);
}

/// Below the tool, where the force along the normal ends: K z + a = 0.
void ContactEstimator::place_plane(const Eigen::Vector3d& tool_m) noexcept {
  const double surface_depth_m = -line_[1] / line_[0];
  const double depth_m = (begin_m_ - tool_m).dot(surface_.normal);
  surface_.place_m = tool_m + (depth_m - surface_depth_m) * surface_.normal;
}

}  // namespace forcebound::server
