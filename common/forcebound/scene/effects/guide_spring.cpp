#include "forcebound/scene/effects/guide_spring.hpp"

#include <algorithm>

namespace forcebound::scene {

GuideSpring::GuideSpring(const Values& values)
    : stiffness_N_per_m_(values.number("stiffness_N_per_m")),
      damping_N_s_per_m_(values.number("damping_N_s_per_m")),
      radius_m_(values.number("radius_m")),
      force_N_max_(values.number("force_N_max")) {}

void GuideSpring::pull(const Point& out_m, const Point& velocity_m_per_s, Reaction& reaction) const noexcept {
  const double distance_m = out_m.norm();
  if (!(distance_m > radius_m_)) return;
  const double spring_N = std::min(stiffness_N_per_m_ * (distance_m - radius_m_), force_N_max_);
  reaction.force_N -= spring_N / distance_m * out_m;
  if (!(damping_N_s_per_m_ > 0)) return;
  const double damper_N = damping_N_s_per_m_ * velocity_m_per_s.norm();
  const double share = damper_N > force_N_max_ ? force_N_max_ / damper_N : 1;
  reaction.force_N -= share * damping_N_s_per_m_ * velocity_m_per_s;
}

EffectFacts GuideSpring::facts() const {
  return {.inputs = {.velocity = damping_N_s_per_m_ > 0},
          .stiffness_N_per_m = stiffness_N_per_m_,
          .damping_N_s_per_m = damping_N_s_per_m_,
          .cost_ns = 10};
}

std::vector<Parameter> GuideSpring::parameters(std::vector<Parameter> own) {
  own.insert(own.end(),
             {positive_number("stiffness_N_per_m", "K, outside of the dead zone", 1e9),
              NumberParameter{.key = "damping_N_s_per_m",
                              .meaning = "B, of the motion away from, toward and around the guide",
                              .preset = 0,
                              .least = 0,
                              .most = 1e6},
              NumberParameter{.key = "radius_m", .meaning = "R, of the dead zone", .preset = 0, .least = 0},
              positive_number("force_N_max", "F, limits the spring and the damper separately",
                              std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity())});
  return own;
}

}  // namespace forcebound::scene
