#include "forcebound/scene/effects/magnet.hpp"

namespace forcebound::scene {
namespace {

class Magnet final : public Effect {
 public:
  explicit Magnet(const Values& values)
      : force_N_max_(values.number("force_N_max")), range_m_(values.number("range_m")) {}

  void act(const Probe& probe, std::byte*, Reaction& reaction) const noexcept override {
    const double share = -probe.penetration_m / range_m_;
    if (!(share > 0 && share < 1)) return;
    reaction.force_N -= force_N_max_ * 6.75 * share * (1 - share) * (1 - share) * probe.normal;
  }

  EffectFacts facts() const override {
    return {.reach_m = range_m_, .stiffness_N_per_m = 6.75 * force_N_max_ / range_m_, .cost_ns = 6};
  }

 private:
  double force_N_max_;
  double range_m_;
};

}  // namespace

EffectKind magnet_effect() {
  return {.name = "magnet",
          .purpose = "draws the point to the surface from a distance",
          .law = "f = -n F 27/4 s (1 - s)^2, s = distance above / range",
          .parameters = {positive_number("force_N_max", "F, at a third of the range", 1e6),
                         NumberParameter{.key = "range_m",
                                         .meaning = "distance above the surface at which it ends",
                                         .least = 1e-6,
                                         .most = 1e3}},
          .make = [](const Values& values) { return std::make_unique<Magnet>(values); }};
}

}  // namespace forcebound::scene
