#include "forcebound/scene/effects/gravity.hpp"

namespace forcebound::scene {
namespace {

class Gravity final : public Effect {
 public:
  explicit Gravity(const Values& values)
      : weight_N_(values.number("mass_kg") * values.number("gravity_m_per_s2") * values.point("direction")) {}

  void act(const Probe&, std::byte*, Reaction& reaction) const noexcept override { reaction.force_N += weight_N_; }

  EffectFacts facts() const override { return {.cost_ns = 2}; }

 private:
  Point weight_N_;
};

}  // namespace

EffectKind gravity_effect() {
  return {.name = "gravity",
          .purpose = "the weight of something in the hand",
          .law = "f = m g e",
          .place = EffectPlace::space,
          .parameters =
              {NumberParameter{.key = "mass_kg", .meaning = "m, of what is held", .least = 0, .most = 1e6},
               PointParameter{.key = "direction", .meaning = "e, direction of gravity", .is_direction = true},
               NumberParameter{
                   .key = "gravity_m_per_s2", .meaning = "g, acceleration", .preset = 9.81, .least = 0, .most = 1e6}},
          .make = [](const Values& values) { return std::make_unique<Gravity>(values); }};
}

}  // namespace forcebound::scene
