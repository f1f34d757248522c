#include "tests/tools/sim/restless_hand.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/device/simulated/smooth_step.hpp"
#include "tests/tools/sim/draw.hpp"

namespace forcebound::sim {

RestlessHand::RestlessHand(const Settings& settings) : settings_(settings) {
  Draw draw(settings.seed);
  const int dof = settings.degrees_of_freedom;
  Act act;
  act.to = act.from = act.shake = control::Vector::Zero(dof);
  for (double time_s = 0; time_s < settings.duration_s || acts_.empty(); time_s += act.length_s) {
    act.begin_s = time_s;
    act.length_s = draw.number(0.05, 0.6);
    act.from = act.to;
    act.shake.setZero();
    act.shakes = 0;
    act.grip = 1;
    switch (draw.index(5)) {
      case 0:
      case 1:  // pulls
        act.to = draw.vector(dof, settings.reach_m);
        break;
      case 2:  // holds
        break;
      case 3:  // shakes, by less than an encoder's count or much more
        act.shake = draw.vector(dof, draw.one_of({1e-5, 1e-4, 5e-3}));
        act.shakes = std::ceil(act.length_s * draw.number(3, 25));
        break;
      default:  // releases
        act.grip = 0;
    }
    acts_.push_back(act);
  }
}

device::Operator::Target RestlessHand::target(double time_s) const noexcept {
  const auto after = std::upper_bound(acts_.begin(), acts_.end(), time_s,
                                      [](double time, const Act& act) { return time < act.begin_s; });
  const Act& act = after == acts_.begin() ? acts_.front() : *(after - 1);
  const double e = std::min(time_s - act.begin_s, act.length_s);
  const auto way = device::smooth_step(2 * e / act.length_s);
  const double phase = 2 * std::numbers::pi * act.shakes / act.length_s;
  Target target;
  target.position = act.from + way.value * (act.to - act.from) + 0.5 * (1 - std::cos(phase * e)) * act.shake;
  target.velocity = way.slope * 2 / act.length_s * (act.to - act.from) + 0.5 * phase * std::sin(phase * e) * act.shake;
  target.grip = act.grip;
  return target;
}

std::string RestlessHand::description() const {
  control::ClassicText text;
  text << "restless:seed=" << settings_.seed << ",mass_kg=" << settings_.hand.mass_kg
       << ",stiffness_N_per_m=" << settings_.hand.stiffness_N_per_m
       << ",damping_N_s_per_m=" << settings_.hand.damping_N_s_per_m << ",reach_m=" << settings_.reach_m;
  return text.str();
}

}  // namespace forcebound::sim
