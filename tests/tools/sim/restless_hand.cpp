#include "tests/tools/sim/restless_hand.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/device/simulated/smooth_step.hpp"
#include "tests/tools/sim/draw.hpp"

namespace forcebound::sim {

RestlessHand::RestlessHand(const Settings& settings)
    : settings_(settings),
      acts_(acts_of(settings.seed, settings.degrees_of_freedom, settings.reach_m, settings.duration_s)),
      turns_(acts_of(~settings.seed, Eigen::Vector3d::RowsAtCompileTime, settings.turn_rad, settings.duration_s)) {}

RestlessHand::Acts RestlessHand::acts_of(std::uint64_t seed, Eigen::Index rows, double reach, double duration_s) {
  Draw draw(seed);
  Acts acts;
  Act act;
  act.to = act.from = act.shake = control::Vector::Zero(rows);
  for (double time_s = 0; time_s < duration_s || acts.empty(); time_s += act.length_s) {
    act.begin_s = time_s;
    act.length_s = draw.number(0.05, 0.6);
    act.from = act.to;
    act.shake.setZero();
    act.shakes = 0;
    act.grip = 1;
    switch (draw.index(5)) {
      case 0:
      case 1:  // pulls
        act.to = draw.vector(rows, reach);
        break;
      case 2:  // holds
        break;
      case 3:  // shakes, by less than an encoder's count or much more
        act.shake = draw.vector(rows, draw.one_of({1e-5, 1e-4, 5e-3}));
        act.shakes = std::ceil(act.length_s * draw.number(3, 25));
        break;
      default:  // releases
        act.grip = 0;
    }
    acts.push_back(act);
  }
  return acts;
}

device::Operator::Target RestlessHand::target(double time_s) const noexcept {
  Target target = target_of(acts_, time_s);
  if (settings_.middle_m.rows() > 0) target.position += settings_.middle_m;
  return target;
}

Eigen::Vector3d RestlessHand::turn(double time_s) const noexcept {
  if (settings_.turn_rad == 0) return Eigen::Vector3d::Zero();
  return target_of(turns_, time_s).position;
}

device::Operator::Target RestlessHand::target_of(const Acts& acts, double time_s) noexcept {
  const auto after = std::upper_bound(acts.begin(), acts.end(), time_s,
                                      [](double time, const Act& act) { return time < act.begin_s; });
  const Act& act = after == acts.begin() ? acts.front() : *(after - 1);
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
  if (settings_.turn_rad > 0) {
    text << ",rotation_stiffness_N_m_per_rad=" << settings_.hand.rotation_stiffness_N_m_per_rad
         << ",rotation_damping_N_m_s_per_rad=" << settings_.hand.rotation_damping_N_m_s_per_rad
         << ",turn_rad=" << settings_.turn_rad;
  }
  return text.str();
}

}  // namespace forcebound::sim
