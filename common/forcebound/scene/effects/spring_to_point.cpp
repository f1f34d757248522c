#include "forcebound/scene/effects/spring_to_point.hpp"

#include "forcebound/scene/effects/guide_spring.hpp"
#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {
namespace {

class SpringToPoint final : public Effect {
 public:
  explicit SpringToPoint(const Values& values) : center_m_(values.point("center_m")), spring_(values) {}

  void act(const Probe& probe, std::byte*, Reaction& reaction) const noexcept override {
    spring_.pull(probe.position_m - center_m_, probe.velocity_m_per_s, reaction);
  }

  EffectFacts facts() const override { return spring_.facts(); }

 private:
  Point center_m_;
  GuideSpring spring_;
};

}  // namespace

EffectKind spring_to_point_effect() {
  return {.name = "spring_to_point",
          .purpose = "holds the device at a point",
          .law = "f = -(o/e) min(K s, F) - min(B, F/|v|) v while s = e - R > 0; o = x - c, e = |o|",
          .place = EffectPlace::space,
          .parameters = GuideSpring::parameters({place_parameter("center_m", "c, where it holds")}),
          .make = [](const Values& values) { return std::make_unique<SpringToPoint>(values); }};
}

}  // namespace forcebound::scene
