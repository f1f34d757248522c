#include "forcebound/scene/effects/attractor.hpp"

#include <algorithm>
#include <cmath>

#include "forcebound/scene/geometry/shape.hpp"

namespace forcebound::scene {
namespace {

// 3 sqrt(3)/2: one over the maximum of s/(1 + s^2)^(3/2), which lies at s = 1/sqrt(2).
constexpr double kPlummer = 2.5980762113533159403;

class Linear final : public Effect {
 public:
  explicit Linear(const Values& values)
      : center_m_(values.point("center_m")),
        force_N_max_(values.number("force_N_max")),
        radius_m_(values.number("radius_m")) {}

  void act(const Probe& probe, std::byte*, Reaction& reaction) const noexcept override {
    const Point out = probe.position_m - center_m_;
    reaction.force_N -= force_N_max_ / std::max(radius_m_, out.norm()) * out;
  }

  EffectFacts facts() const override { return {.stiffness_N_per_m = force_N_max_ / radius_m_, .cost_ns = 6}; }

 private:
  Point center_m_;
  double force_N_max_;
  double radius_m_;
};

class InverseSquare final : public Effect {
 public:
  explicit InverseSquare(const Values& values)
      : center_m_(values.point("center_m")),
        force_N_max_(values.number("force_N_max")),
        radius_m_(values.number("radius_m")) {}

  void act(const Probe& probe, std::byte*, Reaction& reaction) const noexcept override {
    const Point out = (probe.position_m - center_m_) / radius_m_;
    const double softened = 1 + out.squaredNorm();
    reaction.force_N -= kPlummer * force_N_max_ / (softened * std::sqrt(softened)) * out;
  }

  EffectFacts facts() const override {
    return {.stiffness_N_per_m = kPlummer * force_N_max_ / radius_m_, .cost_ns = 8};
  }

 private:
  Point center_m_;
  double force_N_max_;
  double radius_m_;
};

}  // namespace

EffectKind attractor_effect() {
  return {.name = "attractor",
          .purpose = "pulls toward a point",
          .law = "linear: f = -e F min(r/R, 1); inverse_square: f = -e F (3 sqrt(3)/2) (r/R) / (1 + (r/R)^2)^(3/2)",
          .place = EffectPlace::space,
          .parameters = {place_parameter("center_m", "where it pulls to"),
                         NumberParameter{.key = "force_N_max", .meaning = "F, the most", .least = 0, .most = 1e6},
                         NumberParameter{
                             .key = "radius_m", .meaning = "R, within which it softens", .least = 1e-6, .most = 1e6},
                         ChoiceParameter{.key = "falloff",
                                         .meaning = "how the pull depends on the distance r",
                                         .choices = {"linear", "inverse_square"}}},
          .make = [](const Values& values) -> std::unique_ptr<Effect> {
            if (values.choice("falloff") == "linear") return std::make_unique<Linear>(values);
            return std::make_unique<InverseSquare>(values);
          }};
}

}  // namespace forcebound::scene
