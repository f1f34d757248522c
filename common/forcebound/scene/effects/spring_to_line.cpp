#include "forcebound/scene/effects/spring_to_line.hpp"

#include "forcebound/scene/effects/guide_spring.hpp"
#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {
namespace {

class SpringToLine final : public Effect {
 public:
  explicit SpringToLine(const Values& values)
      : through_m_(values.point("through_m")), direction_(values.point("direction")), spring_(values) {}

  void act(const Probe& probe, std::byte*, Reaction& reaction) const noexcept override {
    spring_.pull(across(probe.position_m - through_m_), across(probe.velocity_m_per_s), reaction);
  }

  EffectFacts facts() const override { return spring_.facts(); }

 private:
  [[nodiscard]] Point across(const Point& vector) const noexcept {
    return vector - vector.dot(direction_) * direction_;
  }

  Point through_m_;
  Point direction_;
  GuideSpring spring_;
};

}  // namespace

EffectKind spring_to_line_effect() {
  return {
      .name = "spring_to_line",
      .purpose = "holds the device at a line, free along it",
      .law = "f = -(o/e) min(K s, F) - min(B, F/|w|) w while s = e - R > 0; o, w = x - c, v across the line; e = |o|",
      .place = EffectPlace::space,
      .parameters = GuideSpring::parameters(
          {place_parameter("through_m", "c, on the line"),
           PointParameter{.key = "direction", .meaning = "a, along the line", .is_direction = true}}),
      .make = [](const Values& values) { return std::make_unique<SpringToLine>(values); }};
}

}  // namespace forcebound::scene
