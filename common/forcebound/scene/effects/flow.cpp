#include "forcebound/scene/effects/flow.hpp"

namespace forcebound::scene {
namespace {

constexpr double kHand_m_per_s = 0.5;

class Flow final : public Effect {
 public:
  explicit Flow(const Values& values)
      : velocity_m_per_s_(values.point("velocity_m_per_s")),
        damping_N_s_per_m_(values.number("damping_N_s_per_m")),
        drag_N_s2_per_m2_(values.number("drag_N_s2_per_m2")) {}

  void act(const Probe& probe, std::byte*, Reaction& reaction) const noexcept override {
    const Point seen_m_per_s = velocity_m_per_s_ - probe.velocity_m_per_s;
    reaction.force_N += (damping_N_s_per_m_ + drag_N_s2_per_m2_ * seen_m_per_s.norm()) * seen_m_per_s;
  }

  EffectFacts facts() const override {
    const bool streams = !velocity_m_per_s_.isZero(0);
    return {
        .inputs = {.velocity = true},
        // The drag's slope grows with the speed: that of a fast hand against the stream.
        .damping_N_s_per_m = damping_N_s_per_m_ + 2 * drag_N_s2_per_m2_ * (velocity_m_per_s_.norm() + kHand_m_per_s),
        .drives = streams,
        .fades_without_server = streams,
        .cost_ns = 8};
  }

 private:
  Point velocity_m_per_s_;
  double damping_N_s_per_m_;
  double drag_N_s2_per_m2_;
};

}  // namespace

EffectKind flow_effect() {
  return {.name = "flow",
          .purpose = "a stream that drags the device along",
          .law = "f = B u + C |u| u, u = w - v",
          .place = EffectPlace::space,
          .parameters =
              {PointParameter{
                   .key = "velocity_m_per_s", .meaning = "w, of the fluid", .each = {.least = -1e3, .most = 1e3}},
               NumberParameter{.key = "damping_N_s_per_m", .meaning = "B, linear drag", .least = 0, .most = 1e6},
               NumberParameter{
                   .key = "drag_N_s2_per_m2", .meaning = "C, quadratic drag", .preset = 0, .least = 0, .most = 1e6}},
          .make = [](const Values& values) { return std::make_unique<Flow>(values); }};
}

}  // namespace forcebound::scene
