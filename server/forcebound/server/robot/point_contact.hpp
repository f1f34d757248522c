#pragma once

#include <Eigen/Core>

namespace forcebound::server {

/// What a surface is like.
struct ContactMaterial {
  double stiffness_N_per_m = 1e4;  ///< of one point that touches it, along the normal, > 0
  double damping_s_per_m = 2;      ///< share of the elastic force that is added per m/s of approach, >= 0
  double friction = 0.3;           ///< Coulomb's coefficient, >= 0
};

/// A point that touches a surface, with the surface's stiffness as it is given, and dry friction that sticks.
///
///     F_n = k depth (1 + a approach), not below zero            [Hunt and Crossley 1975]
///     F_t = -k_t s - d_t v_t, cut to friction times F_n         s: how far a bristle is bent since it stuck
///
/// with k_t = 0.8 k. Force and motion are those at the beginning of a step, so a step must be short beside sqrt(m/k).
///
/// Real time: noexcept, no allocation.
class PointContact {
 public:
  struct Touch {
    Eigen::Vector3d normal;    ///< out of the surface, unit length
    double depth_m = 0;        ///< of the point below the surface; at most 0: no contact
    Eigen::Vector3d velocity;  ///< of the point, relative to the surface [m/s]
  };

  /// The force on the point, held for the step. Once for each step, also where nothing touches.
  [[nodiscard]] Eigen::Vector3d force(const ContactMaterial& material, const Touch& touch, double step_s) noexcept;

 private:
  Eigen::Vector3d bent_{Eigen::Vector3d::Zero()};
};

}  // namespace forcebound::server
