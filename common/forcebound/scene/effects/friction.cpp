#include "forcebound/scene/effects/friction.hpp"

#include <stdexcept>

#include "forcebound/scene/effects/bristle.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::scene {
namespace {

class Friction final : public Effect {
 public:
  explicit Friction(const Values& values)
      : law_{values.number("stiffness_N_per_m"), values.number("damping_N_s_per_m")},
        static_(values.number("static_coefficient")),
        dynamic_(values.number("dynamic_coefficient")) {
    if (dynamic_ < 0) dynamic_ = static_;
    if (dynamic_ > static_) {
      throw std::invalid_argument("dynamic_coefficient must be <= static_coefficient, got " + text::to_text(dynamic_) +
                                  " and " + text::to_text(static_));
    }
  }

  void act(const Probe& probe, std::byte* state, Reaction& reaction) const noexcept override {
    reaction.force_N -= state_as<Bristle>(state).move(law_, {static_ * probe.pressure_N, dynamic_ * probe.pressure_N},
                                                      {probe.position_m, probe.normal, probe.interval_s});
  }

  EffectFacts facts() const override {
    return {.inputs = {.time = law_.damping_N_s_per_m > 0, .pressure = true},
            .state_bytes = sizeof(Bristle),
            .stiffness_N_per_m = law_.stiffness_N_per_m,
            .damping_N_s_per_m = law_.damping_N_s_per_m,
            .cost_ns = 20};
  }

 private:
  Bristle::Law law_;
  double static_;
  double dynamic_;
};

}  // namespace

EffectKind friction_effect() {
  return {.name = "friction",
          .purpose = "holds the point to the surface, and drags when it slips",
          .law = "|f_t| <= mu_s N while sticking, = mu_d N while slipping; an elastoplastic bristle between",
          .parameters =
              {NumberParameter{.key = "static_coefficient", .meaning = "mu_s, while it holds", .least = 0, .most = 100},
               // A negative value means that the scene leaves it out: "the same" is no number.
               NumberParameter{.key = "dynamic_coefficient",
                               .meaning = "mu_d <= mu_s, while it slips",
                               .preset = -1,
                               .least = 0,
                               .most = 100,
                               .absent = "mu_s"},
               positive_number("stiffness_N_per_m", "of the bristle, before it slips", 1e9, 1000),
               NumberParameter{
                   .key = "damping_N_s_per_m", .meaning = "of the bristle", .preset = 0, .least = 0, .most = 1e6}},
          .make = [](const Values& values) { return std::make_unique<Friction>(values); }};
}

}  // namespace forcebound::scene
