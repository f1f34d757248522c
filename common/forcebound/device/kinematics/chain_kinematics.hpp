#pragma once

#include <vector>

#include "forcebound/device/kinematics/kinematics.hpp"

namespace forcebound::device {

/// Where a chain's joints and its tip are while all joint angles are 0. Points and directions in the scene frame [m].
struct ChainGeometry {
  struct Joint {
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();    ///< positive angles turn about it by the right-hand rule
    Eigen::Vector3d point_m = Eigen::Vector3d::Zero();  ///< anywhere on the axis
    double start_rad = 0;                               ///< the posture from which positions are looked for
  };
  std::vector<Joint> joints{};  ///< from the base to the tip, at most control::kDofMax
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();
  /// The tip's axes that count: x; x and y; x, y and z; or 6: these and the three rotations. At most as many as joints.
  int tip_axes = 3;

  [[nodiscard]] bool turns() const noexcept { return tip_axes == control::kDofMax; }
};

/// A serial arm of revolute joints, with as many links as there are joints; more joints than axes of the tip leave the
/// tip where it is while the arm moves. By the product of exponentials: with the unit axis w_i and the point c_i
///
///     p = e^[S_1]q_1 ... e^[S_n]q_n p_0                                     [eq. 4.14]
///
///     dp/dq_i = w_i(q) x (p - c_i(q))                                       [5.1.1]
///
/// [K. M. Lynch, F. C. Park, "Modern Robotics", 2017], joint i's axis where the joints before it put it, cut to the
/// rows of the tip's translations. Where rotations count too, the handle's axes are the scene's while all angles are 0,
/// joint i turns the handle about w_i(q), and these are the last three rows of the geometric Jacobian. The
/// exponentials' own Jacobian, of the rotation vector from there, would be another one: torque is power over angular
/// velocity.
///
/// `joints_at` looks for the joints from the start posture by damped least squares
/// [T. Sugihara, "Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method", IEEE Trans. Robotics
/// 27(5), 2011], at most 200 steps: one solution of many, near the start posture, and the same for the same position.
class ChainKinematics final : public Kinematics {
 public:
  /// @throws std::invalid_argument without joints, with too many or with fewer than axes of the tip, for a number of
  /// these that it cannot have, or for an axis without direction
  explicit ChainKinematics(ChainGeometry geometry);

  [[nodiscard]] Vector position(const Vector& joint) const noexcept override;
  [[nodiscard]] Matrix jacobian(const Vector& joint) const noexcept override;
  [[nodiscard]] Vector joints_at(const Vector& position) const noexcept override;
  [[nodiscard]] std::optional<Eigen::Quaterniond> orientation(const Vector& joint) const noexcept override;
  [[nodiscard]] Vector joints_at_pose(const Vector& position,
                                      const Eigen::Quaterniond& orientation) const noexcept override;

 private:
  [[nodiscard]] Eigen::Isometry3d moved(const Vector& joint) const noexcept;
  [[nodiscard]] Vector start() const noexcept;
  [[nodiscard]] Vector missing(const Vector& position, const Eigen::Quaterniond& orientation,
                               const Vector& joint) const noexcept;

  ChainGeometry geometry_;
  Eigen::Index translations_;
};

}  // namespace forcebound::device
