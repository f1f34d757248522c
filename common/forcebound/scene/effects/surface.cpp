#include "forcebound/scene/effects/surface.hpp"

#include <algorithm>

namespace forcebound::scene {
namespace {

class Surface final : public Effect {
 public:
  explicit Surface(const Values& values)
      : stiffness_N_per_m_(values.number("stiffness_N_per_m")),
        stiffening_N_per_m2_(values.number("stiffening_N_per_m2")),
        damping_N_s_per_m_(values.number("damping_N_s_per_m")) {}

  void act(const Probe& probe, std::byte*, Reaction& reaction) const noexcept override {
    const double depth_m = probe.penetration_m;
    const double leaving_m_per_s = probe.velocity_m_per_s.dot(probe.normal);
    const double push_N =
        (stiffness_N_per_m_ + stiffening_N_per_m2_ * depth_m) * depth_m - damping_N_s_per_m_ * leaving_m_per_s;
    reaction.force_N += std::max(0.0, push_N) * probe.normal;
  }

  EffectFacts facts() const override {
    return {.inputs = {.velocity = damping_N_s_per_m_ > 0},
            .stiffness_N_per_m = stiffness_N_per_m_,
            .stiffening_N_per_m2 = 2 * stiffening_N_per_m2_,
            .damping_N_s_per_m = damping_N_s_per_m_,
            .solid = true,
            .cost_ns = 6};
  }

 private:
  double stiffness_N_per_m_;
  double stiffening_N_per_m2_;
  double damping_N_s_per_m_;
};

}  // namespace

EffectKind surface_effect() {
  return {.name = "surface",
          .purpose = "pushes out of the object, like a spring and a damper",
          .law = "f = n max(0, K d + G d^2 - B v.n) while the depth d > 0",
          .parameters =
              {positive_number("stiffness_N_per_m", "K, along the normal", 1e9),
               NumberParameter{
                   .key = "damping_N_s_per_m", .meaning = "B, along the normal", .preset = 0, .least = 0, .most = 1e6},
               NumberParameter{.key = "stiffening_N_per_m2",
                               .meaning = "G, stiffening with depth",
                               .preset = 0,
                               .least = 0,
                               .most = 1e12}},
          .make = [](const Values& values) { return std::make_unique<Surface>(values); }};
}

}  // namespace forcebound::scene
