#include "forcebound/scene/effects/viscosity.hpp"

namespace forcebound::scene {
namespace {

class Viscosity final : public Effect {
 public:
  explicit Viscosity(const Values& values) : damping_N_s_per_m_(values.number("damping_N_s_per_m")) {}

  void act(const Probe& probe, std::byte*, Reaction& reaction) const noexcept override {
    reaction.force_N -= damping_N_s_per_m_ * probe.velocity_m_per_s;
  }

  EffectFacts facts() const override {
    return {.inputs = {.velocity = true}, .damping_N_s_per_m = damping_N_s_per_m_, .cost_ns = 2};
  }

 private:
  double damping_N_s_per_m_;
};

}  // namespace

EffectKind viscosity_effect() {
  return {.name = "viscosity",
          .purpose = "resists every motion",
          .law = "f = -B v",
          .place = EffectPlace::space,
          .parameters = {NumberParameter{.key = "damping_N_s_per_m", .meaning = "B, damping", .least = 0, .most = 1e6}},
          .make = [](const Values& values) { return std::make_unique<Viscosity>(values); }};
}

}  // namespace forcebound::scene
