#include "forcebound/scene/effects/constant_force.hpp"

namespace forcebound::scene {
namespace {

class ConstantForce final : public Effect {
 public:
  explicit ConstantForce(const Point& force_N) : force_N_(force_N) {}

  void act(const Probe&, std::byte*, Reaction& reaction) const noexcept override { reaction.force_N += force_N_; }

  EffectFacts facts() const override { return {.fades_without_server = true, .cost_ns = 2}; }

 private:
  Point force_N_;
};

}  // namespace

EffectKind constant_force_effect() {
  return {.name = "constant_force",
          .purpose = "the same force everywhere and always",
          .law = "f = force_N",
          .place = EffectPlace::space,
          .parameters = {PointParameter{
              .key = "force_N", .meaning = "on the device", .each = {.least = -1e6, .most = 1e6}}},
          .make = [](const Values& values) { return std::make_unique<ConstantForce>(values.point("force_N")); }};
}

}  // namespace forcebound::scene
