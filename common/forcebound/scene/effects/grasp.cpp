#include "forcebound/scene/effects/grasp.hpp"

#include "forcebound/scene/effects/guide_spring.hpp"

namespace forcebound::scene {
namespace {

/// Zero: it holds nothing.
struct Held {
  bool held;
  std::array<double, 3> at_m;
};

class Grasp final : public Effect {
 public:
  explicit Grasp(const Values& values) : button_(values.whole("button")), spring_(values) {}

  void act(const Probe& probe, std::byte* state, Reaction& reaction) const noexcept override {
    Held& held = state_as<Held>(state);
    const bool pressed = probe.handle.pressed(button_);
    if (pressed && !held.held) Eigen::Map<Point>(held.at_m.data()) = probe.position_m;
    held.held = pressed;
    if (!pressed) return;
    spring_.pull(probe.position_m - Eigen::Map<const Point>(held.at_m.data()), probe.velocity_m_per_s, reaction);
  }

  EffectFacts facts() const override {
    EffectFacts facts = spring_.facts();
    facts.state_bytes = sizeof(Held);
    return facts;
  }

 private:
  int button_;
  GuideSpring spring_;
};

}  // namespace

EffectKind grasp_effect() {
  return {.name = "grasp",
          .purpose = "holds the device where a button was pressed, until it is let go",
          .law = "f = -(o/e) min(K s, F) - min(B, F/|v|) v while s = e - R > 0; o = x - g, e = |o|, g = x at the press",
          .place = EffectPlace::space,
          .parameters = GuideSpring::parameters({NumberParameter{.key = "button",
                                                                 .meaning = "of the device, that holds while pressed",
                                                                 .preset = 0,
                                                                 .least = 0,
                                                                 .most = Handle::kButtons - 1,
                                                                 .whole = true}}),
          .make = [](const Values& values) { return std::make_unique<Grasp>(values); }};
}

}  // namespace forcebound::scene
