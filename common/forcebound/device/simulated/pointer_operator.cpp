#include "forcebound/device/simulated/pointer_operator.hpp"

#include <algorithm>
#include <cmath>

namespace forcebound::device {
namespace {

using Allowed = OperatorSettings::Allowed;

// Against a wall of 10 kN/m, 10 mm of pointing push 4 N; with this mass it is damped to half of critical.
constexpr Hand kPointerHand{.mass_kg = 0.1, .stiffness_N_per_m = 400, .damping_N_s_per_m = 6};
// Longer than between two messages of a pointer at 60 Hz, so that their steps are not felt.
constexpr double kFollow_s = 0.02;
constexpr double kSpeed_m_per_s = 0.6;
constexpr double kReach_m = 0.25;
constexpr double kLooseGrip = 0.1;

}  // namespace

void PointerTarget::point_to(const Point& place_m) noexcept {
  if (!std::ranges::all_of(place_m, [](double value) { return std::isfinite(value); })) return;
  for (std::size_t i = 0; i < place_m.size(); ++i) place_m_[i].store(place_m[i], std::memory_order_relaxed);
  held_.store(true, std::memory_order_release);
}

void PointerTarget::press(int button, bool down) noexcept {
  if (button < 0 || button >= control::Handle::kButtons) return;
  const std::uint32_t bit = 1U << static_cast<unsigned>(button);
  if (down) {
    buttons_.fetch_or(bit, std::memory_order_relaxed);
  } else {
    buttons_.fetch_and(~bit, std::memory_order_relaxed);
  }
}

PointerTarget::Point PointerTarget::place_m() const noexcept {
  Point place{};
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = place_m_[i].load(std::memory_order_relaxed);
  return place;
}

PointerOperator::PointerOperator(OperatorSettings settings, int dof)
    : SpecifiedOperator(settings, dof, kPointerHand),
      speed_m_per_s_(settings.number("speed_m_per_s", Allowed::positive, kSpeed_m_per_s)),
      reach_m_(settings.number("reach_m", Allowed::positive, kReach_m)),
      rate_(1 / settings.number("follow_s", Allowed::positive, kFollow_s)) {
  state_.position = settings.offset(dof);
  state_.velocity = Vector::Zero(dof);
  finish(settings);
}

Operator::Target PointerOperator::target(double time_s) const noexcept {
  const double step_s = std::max(0.0, time_s - state_.time_s);
  state_.time_s = std::max(state_.time_s, time_s);
  const bool held = pointer_->held();
  Vector goal = state_.position;
  if (held) {
    const PointerTarget::Point place = pointer_->place_m();
    const Eigen::Index axes = std::min<Eigen::Index>(goal.rows(), PointerTarget::kAxes);
    for (Eigen::Index i = 0; i < axes; ++i)
      goal[i] = std::clamp(place[static_cast<std::size_t>(i)], -reach_m_, reach_m_);
  }
  Vector off = state_.position - goal;
  const double farthest = 2 * speed_m_per_s_ / rate_;
  const double distance = off.norm();
  if (distance > farthest) {
    goal = state_.position - (farthest / distance) * off;
    off = state_.position - goal;
  }
  // The solution for a goal that rests.
  const double decay = std::exp(-rate_ * step_s);
  const Vector slope = state_.velocity + rate_ * off;
  state_.position = goal + decay * (off + step_s * slope);
  state_.velocity = decay * (state_.velocity - rate_ * step_s * slope);
  return {.position = state_.position, .velocity = state_.velocity, .grip = held ? 1 : kLooseGrip};
}

control::Handle PointerOperator::handle(double time_s) const noexcept {
  return {.buttons = SpecifiedOperator::handle(time_s).buttons.value_or(0) | pointer_->buttons()};
}

}  // namespace forcebound::device
