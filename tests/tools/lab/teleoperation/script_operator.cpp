#include "tests/tools/lab/teleoperation/script_operator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "forcebound/text/numbers.hpp"
#include "tests/tools/sim/draw.hpp"

namespace forcebound::lab {
namespace {

constexpr double kTremor_m = 1e-4;
constexpr double kAside_m = 5e-4;
constexpr double kAsideIn_s = 0.5;  // the hand drifts aside as it starts

}  // namespace

ScriptOperator::ScriptOperator(server::Task task, const Settings& settings)
    : task_(std::move(task)), settings_(settings) {
  sim::Draw draw(settings.seed);
  pace_ = draw.number(0.9, 1.1);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    aside_m_[axis] = draw.number(-kAside_m, kAside_m);
    tremor_rad_per_s_[axis] = 2 * std::numbers::pi * draw.number(8, 10);
    tremor_phase_[axis] = draw.number(0, 2 * std::numbers::pi);
  }
}

device::Operator::Target ScriptOperator::target(double time_s) const noexcept {
  const Eigen::Index rows = settings_.degrees_of_freedom;
  Target target{.position = control::Vector::Zero(rows), .velocity = control::Vector::Zero(rows)};
  const double work_s = time_s - kRest_s;
  if (work_s <= 0) return target;
  const server::ScriptTarget now = task_.target(script_s(time_s));
  const Eigen::Vector3d start = task_.target(0).position;
  const Eigen::Matrix3d into = settings_.workspace.rotation.transpose() / settings_.workspace.motion_scale;
  Eigen::Vector3d place = into * (now.position - start);
  Eigen::Vector3d velocity = into * now.velocity * pace_;
  const double share = std::min(1.0, work_s / kAsideIn_s);
  const double smooth = share * share * (3 - 2 * share);
  const double smooth_per_s = 6 * share * (1 - share) / kAsideIn_s;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double angle = tremor_rad_per_s_[axis] * work_s + tremor_phase_[axis];
    const double off = aside_m_[axis] + kTremor_m * std::sin(angle);
    place[axis] += smooth * off;
    velocity[axis] += smooth_per_s * off + smooth * kTremor_m * tremor_rad_per_s_[axis] * std::cos(angle);
  }
  target.position = place.head(rows);
  target.velocity = velocity.head(rows);
  return target;
}

control::Handle ScriptOperator::handle(double time_s) const noexcept {
  return {.gripper = std::clamp(task_.target(std::max(0.0, script_s(time_s))).grip, 0.0, 1.0)};
}

std::string ScriptOperator::description() const {
  return "script of task " + task_.name + ", pace " + text::fixed(pace_, 2) + ", hand of " +
         text::rounded(settings_.hand.mass_kg, 2) + " kg, " + text::rounded(settings_.hand.stiffness_N_per_m) +
         " N/m, " + text::rounded(settings_.hand.damping_N_s_per_m, 2) + " N s/m";
}

}  // namespace forcebound::lab
