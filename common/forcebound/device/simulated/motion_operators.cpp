#include "forcebound/device/simulated/motion_operators.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "forcebound/device/simulated/smooth_step.hpp"

namespace forcebound::device {
namespace {

using Allowed = OperatorSettings::Allowed;

// The hands, each for all laws. The paper gives none; a relaxed grip has a few hundred N/m.
constexpr Hand kPressHand{.mass_kg = 0.05, .stiffness_N_per_m = 1000, .damping_N_s_per_m = 4};
constexpr Hand kCircleHand{.mass_kg = 0.12, .stiffness_N_per_m = 100, .damping_N_s_per_m = 2.25};
constexpr Hand kSphereHand{.mass_kg = 0.1, .stiffness_N_per_m = 200, .damping_N_s_per_m = 0.3};
constexpr Hand kStrokeHand{.mass_kg = 0.1, .stiffness_N_per_m = 200, .damping_N_s_per_m = 1};
constexpr Hand kCarryHand{.mass_kg = 0.1, .stiffness_N_per_m = 300, .damping_N_s_per_m = 3};
constexpr Hand kWaveHand{.mass_kg = 0, .stiffness_N_per_m = 150, .damping_N_s_per_m = 0.3};

Operator::Target at_rest(int dof) noexcept { return {Vector::Zero(dof), Vector::Zero(dof)}; }

}  // namespace

PressOperator::PressOperator(OperatorSettings settings, int dof)
    : SpecifiedOperator(settings, dof, kPressHand),
      axis_(settings.integer("axis", 0, dof - 1, 0)),
      from_m_(settings.number("from_m", Allowed::any, -0.01)),
      to_m_(settings.number("to_m", Allowed::any, 0.02)),
      wait_s_(settings.number("wait_s", Allowed::not_negative, 0.1)),
      approach_s_(settings.number("approach_s", Allowed::positive, 0.4)) {
  finish(settings);
}

Operator::Target PressOperator::target(double time_s) const noexcept {
  const SmoothStep step = smooth_step((time_s - wait_s_) / approach_s_);
  Target target = at_rest(degrees_of_freedom());
  target.position[axis_] = from_m_ + (to_m_ - from_m_) * step.value;
  target.velocity[axis_] = (to_m_ - from_m_) / approach_s_ * step.slope;
  return target;
}

TraceOperator::TraceOperator(OperatorSettings settings, int dof, Wall wall)
    : SpecifiedOperator(settings, dof, wall == Wall::around ? kCircleHand : kSphereHand) {
  if (dof < 2) throw std::invalid_argument("operator '" + settings.name() + "': needs 2 degrees of freedom, has 1");
  const bool around = wall == Wall::around;
  const double radius = settings.number("radius_m", Allowed::positive, around ? 0.04 : 0.02);
  const double depth = settings.number("depth_m", Allowed::any, around ? 0.012 : 0.0125);
  trace_radius_m_ = around ? radius + depth : radius - depth;
  start_radius_m_ = around ? 0 : radius + settings.number("clearance_m", Allowed::not_negative, 0.02);
  turn_s_ = settings.number("turn_s", Allowed::positive, around ? 8 : 6);
  approach_s_ = settings.number("approach_s", Allowed::positive, around ? 0.5 : 1);
  finish(settings);
}

Operator::Target TraceOperator::target(double time_s) const noexcept {
  const SmoothStep approach = smooth_step(time_s / approach_s_);
  const double radius = start_radius_m_ + (trace_radius_m_ - start_radius_m_) * approach.value;
  const double outward = (trace_radius_m_ - start_radius_m_) / approach_s_ * approach.slope;

  // Once there, the turning sets in as gently, and takes as long to do so.
  const SmoothStep turning = smooth_step(time_s / approach_s_ - 1);
  const double full_speed = 2 * std::numbers::pi / turn_s_;
  const double angle = full_speed * approach_s_ * turning.integral;
  const double along = radius * full_speed * turning.value;

  Target target = at_rest(degrees_of_freedom());
  target.position.head(2) << radius * std::cos(angle), radius * std::sin(angle);
  target.velocity.head(2) << outward * std::cos(angle) - along * std::sin(angle),
      outward * std::sin(angle) + along * std::cos(angle);
  return target;
}

StrokeOperator::StrokeOperator(OperatorSettings settings, int dof)
    : SpecifiedOperator(settings, dof, kStrokeHand),
      height_m_(settings.number("height_m", Allowed::not_negative, 0.02)),
      depth_m_(settings.number("depth_m", Allowed::any, 0.008)),
      length_m_(settings.number("length_m", Allowed::not_negative, 0.03)),
      turn_s_(settings.number("turn_s", Allowed::positive, 2)),
      approach_s_(settings.number("approach_s", Allowed::positive, 1)),
      offset_m_(settings.offset(dof)) {
  if (dof < 3) {
    throw std::invalid_argument("operator '" + settings.name() + "': needs 3 degrees of freedom, has " +
                                std::to_string(dof));
  }
  finish(settings);
}

Operator::Target StrokeOperator::target(double time_s) const noexcept {
  const SmoothStep approach = smooth_step(time_s / approach_s_);
  // Once there, the turning sets in as gently, and takes as long to do so.
  const SmoothStep turning = smooth_step(time_s / approach_s_ - 1);
  const double full_speed = 2 * std::numbers::pi / turn_s_;
  const double angle = full_speed * approach_s_ * turning.integral;
  const double half_m = 0.5 * length_m_;
  Target target{offset_m_, Vector::Zero(degrees_of_freedom())};
  target.position.head(3) += Eigen::Vector3d(half_m * std::sin(angle), 0.5 * half_m * std::sin(2 * angle),
                                             height_m_ - (height_m_ + depth_m_) * approach.value);
  target.velocity.head(3) << full_speed * turning.value * half_m *
                                 Eigen::Vector2d(std::cos(angle), std::cos(2 * angle)),
      -(height_m_ + depth_m_) / approach_s_ * approach.slope;
  return target;
}

CarryOperator::CarryOperator(OperatorSettings settings, int dof)
    : SpecifiedOperator(settings, dof, kCarryHand),
      height_m_(settings.number("height_m", Allowed::not_negative, 0.02)),
      depth_m_(settings.number("depth_m", Allowed::any, 0.004)),
      lift_m_(settings.number("lift_m", Allowed::not_negative, 0.03)),
      length_m_(settings.number("length_m", Allowed::any, 0.06)),
      approach_s_(settings.number("approach_s", Allowed::positive, 1)),
      wait_s_(settings.number("wait_s", Allowed::not_negative, 0.5)),
      carry_s_(settings.number("carry_s", Allowed::positive, 2)),
      offset_m_(settings.offset(dof)) {
  if (dof < 3) {
    throw std::invalid_argument("operator '" + settings.name() + "': needs 3 degrees of freedom, has " +
                                std::to_string(dof));
  }
  const double down_s = approach_s_ + 0.5 * wait_s_;
  presses({.button = settings.integer("button", 0, control::Handle::kButtons - 1, 0),
           .from_s = down_s,
           .until_s = down_s + wait_s_ + 2 * approach_s_ + carry_s_});
  finish(settings);
}

Operator::Target CarryOperator::target(double time_s) const noexcept {
  const double lift_from_s = approach_s_ + wait_s_;
  const double carry_from_s = lift_from_s + approach_s_;
  const double lower_from_s = carry_from_s + carry_s_;
  const double leave_from_s = lower_from_s + approach_s_ + wait_s_;
  Target target{offset_m_, Vector::Zero(degrees_of_freedom())};
  target.position[2] += height_m_;
  const auto go = [&](int axis, double way_m, double from_s, double for_s) {
    const SmoothStep step = smooth_step((time_s - from_s) / for_s);
    target.position[axis] += way_m * step.value;
    target.velocity[axis] += way_m / for_s * step.slope;
  };
  go(2, -height_m_ - depth_m_, 0, approach_s_);
  go(2, depth_m_ + lift_m_, lift_from_s, approach_s_);
  go(0, length_m_, carry_from_s, carry_s_);
  go(2, -depth_m_ - lift_m_, lower_from_s, approach_s_);
  go(2, height_m_ + depth_m_, leave_from_s, approach_s_);
  return target;
}

WaveOperator::WaveOperator(OperatorSettings settings, int dof)
    : SpecifiedOperator(settings, dof, kWaveHand),
      amplitude_m_(settings.number("amplitude_m", Allowed::not_negative, 0.03)),
      frequency_Hz_(settings.number("frequency_Hz", Allowed::positive, 0.7)),
      offset_m_(settings.offset(dof)) {
  finish(settings);
}

Operator::Target WaveOperator::target(double time_s) const noexcept {
  // Square roots of primes have no common multiple, so the motion never repeats.
  static constexpr std::array<double, control::kDofMax> kPace = {1.0,       1.4142136, 0.7320508,
                                                                 1.2360680, 0.6457513, 1.3166248};
  constexpr double kSecondPace = 1.7320508;
  const SmoothStep fade = smooth_step(time_s);
  Target target = at_rest(degrees_of_freedom());
  for (int i = 0; i < degrees_of_freedom(); ++i) {
    const double slow = 2 * std::numbers::pi * frequency_Hz_ * kPace[static_cast<std::size_t>(i)];
    const double fast = slow * kSecondPace;
    const double wave = 0.5 * (std::sin(slow * time_s) + std::sin(fast * time_s));
    const double wave_speed = 0.5 * (slow * std::cos(slow * time_s) + fast * std::cos(fast * time_s));
    target.position[i] = offset_m_[i] + amplitude_m_ * fade.value * wave;
    target.velocity[i] = amplitude_m_ * (fade.slope * wave + fade.value * wave_speed);
  }
  return target;
}

}  // namespace forcebound::device
