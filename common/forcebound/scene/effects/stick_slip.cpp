#include "forcebound/scene/effects/stick_slip.hpp"

namespace forcebound::scene {
namespace {

struct Anchor {
  double place_m[3];
  double set;
};

class StickSlip final : public Effect {
 public:
  explicit StickSlip(const Values& values)
      : stiffness_N_per_m_(values.number("stiffness_N_per_m")), slip_N_(values.number("slip_N")) {}

  void act(const Probe& probe, std::byte* state, Reaction& reaction) const noexcept override {
    auto& anchor = state_as<Anchor>(state);
    Eigen::Map<Point> place_m(anchor.place_m);
    if (anchor.set == 0) place_m = probe.position_m;
    anchor.set = 1;
    const Point stretched_m = probe.position_m - place_m;
    const Point sideways_m = stretched_m - probe.normal.dot(stretched_m) * probe.normal;
    if (stiffness_N_per_m_ * sideways_m.norm() > slip_N_) {
      place_m = probe.position_m;
    } else {
      reaction.force_N -= stiffness_N_per_m_ * sideways_m;
    }
  }

  EffectFacts facts() const override {
    return {.state_bytes = sizeof(Anchor), .stiffness_N_per_m = stiffness_N_per_m_, .cost_ns = 10};
  }

 private:
  double stiffness_N_per_m_;
  double slip_N_;
};

}  // namespace

EffectKind stick_slip_effect() {
  return {.name = "stick_slip",
          .purpose = "sticks and slips in jerks",
          .law = "f = -K (x - a) in the tangent plane; the anchor a jumps to x when |f| would exceed slip_N",
          .parameters = {positive_number("stiffness_N_per_m", "K, while it sticks", 1e9),
                         positive_number("slip_N", "force at which it slips", 1e6)},
          .make = [](const Values& values) { return std::make_unique<StickSlip>(values); }};
}

}  // namespace forcebound::scene
