#include "forcebound/scene/effects/adhesion.hpp"

#include <algorithm>

#include "forcebound/scene/effects/bristle.hpp"

namespace forcebound::scene {
namespace {

struct Glue {
  double holds;
  Bristle sideways;
};

class Adhesion final : public Effect {
 public:
  explicit Adhesion(const Values& values)
      : stiffness_N_per_m_(values.number("stiffness_N_per_m")),
        tear_N_(values.number("tear_N")),
        shear_{values.number("shear_stiffness_N_per_m"), 0},
        shear_N_(values.number("shear_N")) {
    if (shear_.stiffness_N_per_m == 0) shear_.stiffness_N_per_m = stiffness_N_per_m_;
  }

  void act(const Probe& probe, std::byte* state, Reaction& reaction) const noexcept override {
    auto& glue = state_as<Glue>(state);
    if (probe.penetration_m > 0) glue.holds = 1;
    if (-stiffness_N_per_m_ * probe.penetration_m > tear_N_) glue = {};
    if (glue.holds == 0) return;
    if (probe.penetration_m < 0) reaction.force_N += stiffness_N_per_m_ * probe.penetration_m * probe.normal;
    reaction.force_N -=
        glue.sideways.move(shear_, {shear_N_, shear_N_}, {probe.position_m, probe.normal, probe.interval_s});
  }

  EffectFacts facts() const override {
    return {.state_bytes = sizeof(Glue),
            .reach_m = tear_N_ / stiffness_N_per_m_,
            .stiffness_N_per_m = std::max(stiffness_N_per_m_, shear_.stiffness_N_per_m),
            .cost_ns = 20};
  }

 private:
  double stiffness_N_per_m_;
  double tear_N_;
  Bristle::Law shear_;
  double shear_N_;
};

}  // namespace

EffectKind adhesion_effect() {
  return {.name = "adhesion",
          .purpose = "sticks to the point: it must be torn off, and holds sideways",
          .law = "f = -n K h - f_t above the surface that was touched, until K h > tear_N",
          .parameters = {positive_number("stiffness_N_per_m", "K, along the normal", 1e9),
                         positive_number("tear_N", "force at which it tears", 1e6),
                         NumberParameter{.key = "shear_stiffness_N_per_m",
                                         .meaning = "sideways",
                                         .preset = 0,
                                         .least = 0,
                                         .least_excluded = true,
                                         .most = 1e9,
                                         .absent = "K"},
                         NumberParameter{.key = "shear_N",
                                         .meaning = "sideways force at which it slips",
                                         .preset = 0,
                                         .least = 0,
                                         .most = 1e6}},
          .make = [](const Values& values) { return std::make_unique<Adhesion>(values); }};
}

}  // namespace forcebound::scene
