#include "ratchet.hpp"

#include <algorithm>

namespace {

using namespace forcebound::scene;

class Ratchet final : public Effect {
 public:
  explicit Ratchet(const Values& values)
      : stiffness_N_per_m_(values.number("stiffness_N_per_m")), direction_(values.point("direction")) {}

  void act(const Probe& probe, std::byte* state, Reaction& reaction) const noexcept override {
    auto& reached = state_as<Reached>(state);
    const double here_m = direction_.dot(probe.position_m);
    reached.most_m = reached.any ? std::max(reached.most_m, here_m) : here_m;
    reached.any = true;
    reaction.force_N += stiffness_N_per_m_ * (reached.most_m - here_m) * direction_;
  }

  EffectFacts facts() const override {
    return {.state_bytes = sizeof(Reached), .stiffness_N_per_m = stiffness_N_per_m_};
  }

 private:
  // All bytes zero: nothing reached yet.
  struct Reached {
    double most_m;
    bool any;
  };

  double stiffness_N_per_m_;
  Point direction_;
};

}  // namespace

EffectKind ratchet_effect() {
  return {.name = "ratchet",
          .purpose = "gives way in one direction and holds in the other",
          .law = "f = K (max s - s) e, s = e.x",
          .place = EffectPlace::space,
          .parameters = {NumberParameter{.key = "stiffness_N_per_m",
                                         .meaning = "K, against going back",
                                         .least = 0,
                                         .least_excluded = true,
                                         .most = 1e6},
                         PointParameter{.key = "direction",
                                        .meaning = "e, where it gives way",
                                        .preset = Point::UnitX(),
                                        .is_direction = true}},
          .make = [](const Values& values) { return std::make_unique<Ratchet>(values); }};
}
