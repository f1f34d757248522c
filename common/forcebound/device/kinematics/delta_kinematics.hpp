#pragma once

#include <array>

#include "forcebound/device/kinematics/kinematics.hpp"

namespace forcebound::device {

/// The size of a delta mechanism and where it stands. It looks at the user: the axis of its base is level, and its
/// platform in front of the base.
struct DeltaGeometry {
  double base_radius_m = 0;       ///< from the base's axis to each driven joint
  double platform_radius_m = 0;   ///< from the platform's middle, the tip, to where each forearm ends
  double upper_arm_length_m = 0;  ///< from driven joint to knee
  double forearm_length_m = 0;    ///< of the parallelogram from the knee to the platform
  double side_offset_m = 0;       ///< how far a driven joint is beside its arm's radius, less how far its forearm's end
                                  ///< is; to the side on which the next arm follows
  double first_arm_rad = 0;       ///< direction of the first arm, from the user's right upwards; the others follow by
                                  ///< a third of a turn each
  double origin_reach_m = 0;      ///< distance of the scene's origin in front of the base
};

/// Three driven arms, a third of a turn apart; parallelograms from their knees carry a platform, the tip, that never
/// turns [R. Clavel, "Delta, a fast robot with parallel geometry", 18th Int. Symp. on Industrial Robots, 1988].
///
/// joint: each arm's angle [rad], 0 where it points away from the base's axis, growing towards the user. With the
/// radius R of the base, that of the platform r, upper arm a, forearm b, side offset s, and for arm i the unit vectors
/// u_i outwards, t_i across (a quarter of a turn on from u_i) and w to the front
///
///     centre  c_i = (R - r + a cos q_i) u_i + s t_i + a sin q_i w
///     tip     p   where |p - c_i| = b for all three, in front of the plane of the c_i
///                   [the intersection of three spheres: P. J. Zsombor-Murray, "Descriptive geometric kinematic
///                   analysis of Clavel's Delta robot", McGill 2004]
///             p   = o + sqrt(b^2 - rho^2) n: o the middle of the circle through the c_i, rho its radius, n its normal
///     joints  q_i = phi - acos(k/d): with X = p.u_i - (R - r), Y = p.t_i - s, W = p.w,  phi = atan2(W, X),
///                   d = sqrt(X^2 + W^2),  k = (X^2 + Y^2 + W^2 + a^2 - b^2)/(2 a);  the knee is outside
///     p'      = A^-1 B q':  row i of A is (p - c_i)',  B_ii = (p - c_i)' dc_i/dq_i      [from |p - c_i|^2 = b^2]
///
/// and x = p to the right, z = p upwards, y = origin reach - p.w. A turn of the handle is not in it: a wrist on the
/// platform has joints of its own.
///
/// Where the forearms lie in one plane the platform has freedom of its own; its velocity, which has no bound near such
/// a place, is bounded here, by what it is where the forearms' unit vectors span 0.01. Where the spheres do not meet,
/// so that nothing can be assembled, the tip is at o.
class DeltaKinematics final : public Kinematics {
 public:
  explicit DeltaKinematics(const DeltaGeometry& geometry);

  [[nodiscard]] Vector position(const Vector& joint) const noexcept override;
  [[nodiscard]] Matrix jacobian(const Vector& joint) const noexcept override;
  [[nodiscard]] Vector joints_at(const Vector& position) const noexcept override;

 private:
  static constexpr int kArms = 3;
  using Point = Eigen::Vector3d;  // to the right, upwards, to the front of the base
  using Centres = std::array<Point, kArms>;

  [[nodiscard]] Centres centres(const Vector& joint) const noexcept;
  [[nodiscard]] Point tip(const Centres& centres) const noexcept;
  [[nodiscard]] Vector joints_of(const Point& tip) const noexcept;

  DeltaGeometry geometry_;
  std::array<Point, kArms> outward_;
  std::array<Point, kArms> across_;
};

}  // namespace forcebound::device
