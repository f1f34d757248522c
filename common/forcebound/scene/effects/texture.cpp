#include "forcebound/scene/effects/texture.hpp"

#include <Eigen/Geometry>
#include <numbers>

namespace forcebound::scene {
namespace {

class TextureEffect final : public Effect {
 public:
  explicit TextureEffect(const Values& values)
      : amplitude_N_(values.number("amplitude_N")),
        wave_rad_per_m_(2 * std::numbers::pi / values.number("wavelength_m")),
        direction_(values.point("direction")),
        waves_(values.choice("pattern") == "grid" ? 2 : 1) {}

  void act(const Probe& probe, std::byte*, Reaction& reaction) const noexcept override {
    const Point along = direction_ - probe.normal.dot(direction_) * probe.normal;
    const double length = along.norm();
    if (!(length > kAlongNormal)) return;
    const Point wave = wave_rad_per_m_ / length * along;
    reaction.texture = {amplitude_N_, waves_, {wave, probe.normal.cross(wave)}};
  }

  // Up on the crests and down in the troughs takes energy out of it each time.
  EffectFacts facts() const override {
    return {.stiffness_N_per_m = amplitude_N_ * wave_rad_per_m_, .drives = true, .cost_ns = 10};
  }

 private:
  // Nearer to the normal than this, the direction on the surface would be rounding error.
  static constexpr double kAlongNormal = 1e-9;

  double amplitude_N_;
  double wave_rad_per_m_;
  Point direction_;
  int waves_;
};

}  // namespace

EffectKind texture_effect() {
  return {.name = "texture",
          .purpose = "ripples, rendered at the device at its own rate",
          .law = "f = n A mean_i sin(k_i . x) at the device's own position x, |k_i| = 2 pi / wavelength",
          .parameters =
              {positive_number("amplitude_N", "A, from mean to peak", 1e6),
               NumberParameter{.key = "wavelength_m", .meaning = "from ridge to ridge", .least = 1e-6, .most = 1e3},
               PointParameter{
                   .key = "direction", .meaning = "across the ridges", .preset = Point::UnitX(), .is_direction = true},
               ChoiceParameter{.key = "pattern", .meaning = "one wave or two", .choices = {"ridges", "grid"}}},
          .make = [](const Values& values) { return std::make_unique<TextureEffect>(values); }};
}

}  // namespace forcebound::scene
