#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "forcebound/time/clock.hpp"

namespace forcebound::server {

using time::Nanoseconds;

/// A surface as the robot has felt it, world frame.
struct FeltSurface {
  bool known = false;
  bool touched = false;                              ///< now
  std::uint32_t id = 0;                              ///< the same as long as it is the same surface
  Eigen::Vector3d place_m{Eigen::Vector3d::Zero()};  ///< on it, below the tool
  Eigen::Vector3d normal{Eigen::Vector3d::UnitZ()};  ///< unit, out of it
  double stiffness_N_per_m = 0;
  double friction = 0;   ///< coefficient, 0 to 1, once the tool has slid there
  double certainty = 0;  ///< of the stiffness, 0 to 1: one less its standard deviation over itself
};

/// What an estimator trusts.
struct ContactSettings {
  double touch_N = 1;                    ///< a force above this is contact,
  double leave_N = 0.4;                  ///< until it is below this
  double stiffness_N_per_m_least = 100;  ///< estimates are kept within these
  double stiffness_N_per_m_most = 20000;
  double stiffness_N_per_m_first = 2000;  ///< before anything is known
  double forgetting = 0.998;              ///< per sample, above 0 to 1
  double noise_N = 0.2;                   ///< standard deviation of the sensor
  double normal_s = 0.02;                 ///< time constant of the normal's low-pass
  double friction_s = 0.1;                ///< likewise of the friction's
  double another_angle_rad = 0.5;         ///< a normal further off, for so many samples, is that of another surface,
  int another_samples = 20;
  double another_m = 5e-3;  ///< and so is a touch further from the plane
};

/// Finds plane, stiffness and friction of what a tool touches, from its place and the force that it exerts.
///
/// Normal: the direction of the contact force, less its part along the tool's sliding, which is friction and noise;
/// low-passed.
/// Stiffness: recursive least squares with forgetting [Ljung 1999, ch. 11] for f_n = K z + a, z the depth along the
/// normal from where the contact began. The plane is where that line says that the force ends. Friction: |f_t|/f_n
/// while the tool slides, low-passed.
///
/// What it trusts is bounded: K within its limits, and no estimate where the depth has not varied. After the contact
/// the surface stays known, until the tool touches another one or moves through where it should be.
///
/// Real time: noexcept, no allocation.
class ContactEstimator {
 public:
  explicit ContactEstimator(const ContactSettings& settings = {}) noexcept : settings_(settings) {}

  /// @param tool_m place of the tool's point; @param velocity_m_per_s of it; @param force_N of the tool on its
  /// surroundings, less the sensor's bias; world frame, finite
  const FeltSurface& update(Nanoseconds now, const Eigen::Vector3d& tool_m, const Eigen::Vector3d& velocity_m_per_s,
                            const Eigen::Vector3d& force_N) noexcept;

  [[nodiscard]] const FeltSurface& surface() const noexcept { return surface_; }

 private:
  void begin_contact(const Eigen::Vector3d& tool_m, const Eigen::Vector3d& normal) noexcept;
  void learn(double depth_m, double normal_N) noexcept;
  void place_plane(const Eigen::Vector3d& tool_m) noexcept;

  ContactSettings settings_;
  FeltSurface surface_;
  Eigen::Vector3d begin_m_{Eigen::Vector3d::Zero()};  // where the contact began
  Eigen::Vector2d line_{Eigen::Vector2d::Zero()};     // K and a
  Eigen::Matrix2d covariance_{Eigen::Matrix2d::Identity()};
  double friction_ = 0;  // low-passed, as it was seen; below zero by noise alone
  int aside_ = 0;        // samples in a row whose force points elsewhere
  Nanoseconds last_{0};
};

}  // namespace forcebound::server
