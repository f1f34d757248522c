#include "forcebound/server/robot/point_contact.hpp"

#include <algorithm>

namespace forcebound::server {

Eigen::Vector3d PointContact::force(const ContactMaterial& material, const Touch& touch, double step_s) noexcept {
  const double approach = -touch.normal.dot(touch.velocity);
  const double elastic_N = material.stiffness_N_per_m * touch.depth_m;
  const double pressed_N = std::max(0.0, elastic_N * (1 + material.damping_s_per_m * approach));
  if (!(touch.depth_m > 0) || !(pressed_N > 0)) {
    bent_.setZero();
    return Eigen::Vector3d::Zero();
  }
  constexpr double kTangential = 0.8;
  // Damps a kilogram on the bristles by a tenth of what is critical.
  constexpr double kDamping_s = 1e-3;
  const double bristle_N_per_m = kTangential * material.stiffness_N_per_m;
  const Eigen::Vector3d sliding = touch.velocity + approach * touch.normal;
  bent_ -= touch.normal.dot(bent_) * touch.normal;
  bent_ += step_s * sliding;
  Eigen::Vector3d along = -bristle_N_per_m * bent_ - kDamping_s * bristle_N_per_m * sliding;
  const double most_N = material.friction * pressed_N;
  const double size_N = along.norm();
  if (size_N > most_N) {
    along *= most_N / size_N;
    bent_ = -along / bristle_N_per_m;
  }
  return pressed_N * touch.normal + along;
}

}  // namespace forcebound::server
