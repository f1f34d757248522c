#include "forcebound/scene/effects/spring_to_plane.hpp"

#include "forcebound/scene/effects/guide_spring.hpp"
#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {
namespace {

class SpringToPlane final : public Effect {
 public:
  explicit SpringToPlane(const Values& values)
      : through_m_(values.point("through_m")), normal_(values.point("normal")), spring_(values) {}

  void act(const Probe& probe, std::byte*, Reaction& reaction) const noexcept override {
    spring_.pull(along(probe.position_m - through_m_), along(probe.velocity_m_per_s), reaction);
  }

  EffectFacts facts() const override { return spring_.facts(); }

 private:
  [[nodiscard]] Point along(const Point& vector) const noexcept { return vector.dot(normal_) * normal_; }

  Point through_m_;
  Point normal_;
  GuideSpring spring_;
};

}  // namespace

EffectKind spring_to_plane_effect() {
  return {.name = "spring_to_plane",
          .purpose = "holds the device at a plane, free within it",
          .law = "f = -(o/e) min(K s, F) - min(B, F/|w|) w while s = e - R > 0; o, w = x - c, v along n; e = |o|",
          .place = EffectPlace::space,
          .parameters = GuideSpring::parameters(
              {place_parameter("through_m", "c, on the plane"),
               PointParameter{.key = "normal", .meaning = "n, of the plane", .is_direction = true}}),
          .make = [](const Values& values) { return std::make_unique<SpringToPlane>(values); }};
}

}  // namespace forcebound::scene
