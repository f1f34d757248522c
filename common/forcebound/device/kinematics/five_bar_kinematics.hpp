#pragma once

#include <array>

#include "forcebound/device/kinematics/kinematics.hpp"

namespace forcebound::device {

/// The size of a planar five-bar linkage and where it stands [m].
struct FiveBarGeometry {
  double base_distance_m = 0;    ///< between the two driven joints, 0: on one axis
  double proximal_length_m = 0;  ///< from each driven joint to its elbow
  double distal_length_m = 0;    ///< from each elbow to the tip
  double origin_reach_m = 0;     ///< distance of the scene's origin in front of the middle of the driven joints
};

/// Two driven joints beside each other, two links from each, which meet in the tip: a pantograph, in a level plane.
///
/// joint = (left, right) [rad], from the direction to the user's right, growing towards the user. With the base
/// distance d, the links a (proximal) and b (distal), w = origin reach - y the distance in front of the base, and s =
/// -1 on the left, +1 on the right, in (x, w)
///
///     elbow   e_i = (s_i d/2 + a cos q_i, a sin q_i)
///     tip     p   = (e_l + e_r)/2 + h n,  c = |e_r - e_l|,  h = sqrt(b^2 - c^2/4),  n = the unit vector to the front,
///                   across e_r - e_l                              [the intersection of two circles about the elbows]
///     joints  q_i = direction of (p - base_i) -+ acos((a^2 + r_i^2 - b^2)/(2 a r_i)),  r_i = |p - base_i|
///     p'      = A^-1 B q':  row i of A is (p - e_i)',  B_ii = (p - e_i)' de_i/dq_i  [from |p - e_i|^2 = b^2]
///
/// as in G. Campion, Q. Wang, V. Hayward, "The Pantograph Mk-II: a haptic instrument", IROS 2005. Of the two ways to
/// assemble it the tip is in front of the elbows, and of the four ways to reach a place the elbows are outside, the
/// left one on the left: as such devices are built.
///
/// The distal links are parallel in a singular place: there the tip has freedom of its own, and its velocity, which
/// has no bound near it, is bounded here by that at 0.6 degrees between them. Where the elbows are further apart than 2
/// b, so that nothing can be assembled, the tip is in the middle between them.
class FiveBarKinematics final : public Kinematics {
 public:
  explicit FiveBarKinematics(const FiveBarGeometry& geometry) : geometry_(geometry) {}

  [[nodiscard]] Vector position(const Vector& joint) const noexcept override;
  [[nodiscard]] Matrix jacobian(const Vector& joint) const noexcept override;
  [[nodiscard]] Vector joints_at(const Vector& position) const noexcept override;

 private:
  using Plane = Eigen::Vector2d;  // x and distance in front of the base

  [[nodiscard]] Plane base(int side) const noexcept;
  [[nodiscard]] std::array<Plane, 2> elbows(const Vector& joint) const noexcept;
  [[nodiscard]] Plane tip(const std::array<Plane, 2>& elbows) const noexcept;

  FiveBarGeometry geometry_;
};

}  // namespace forcebound::device
