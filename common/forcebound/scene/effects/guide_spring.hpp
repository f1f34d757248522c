#pragma once

#include <vector>

#include "forcebound/scene/effects/effect.hpp"

namespace forcebound::scene {

/// A spring and a damper that hold the device at a guide: a point, a line or a plane. With o from the guide's nearest
/// point to the device, e = |o| and w the part of the velocity v that leads away from, toward or around the guide:
///
///     f = -(o/e) min(K s, F) - min(B, F/|w|) w,    s = e - R > 0;    f = 0 within the dead zone, s <= 0
///
/// F limits the spring and the damper separately, by clipping, so the spring stays conservative and the damper only
/// dissipates. On the guide itself there is no direction and no force.
///
/// Parameters: `stiffness_N_per_m` K > 0, `damping_N_s_per_m` B >= 0 (default 0), `radius_m` R >= 0 (default 0),
/// `force_N_max` F > 0 (default: no limit).
class GuideSpring {
 public:
  explicit GuideSpring(const Values& values);

  /// `out_m` is o; `velocity_m_per_s` is w.
  void pull(const Point& out_m, const Point& velocity_m_per_s, Reaction& reaction) const noexcept;

  [[nodiscard]] EffectFacts facts() const;

  /// `own` ones, then those of every guide.
  [[nodiscard]] static std::vector<Parameter> parameters(std::vector<Parameter> own);

 private:
  double stiffness_N_per_m_;
  double damping_N_s_per_m_;
  double radius_m_;
  double force_N_max_;
};

}  // namespace forcebound::scene
