#include "forcebound/local_model/dragged_mass.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace forcebound::local_model {
namespace {

constexpr double kStepMost_s = 1e-3;
constexpr double kStepsMost = 100;

/// For a tick or the rest of one, which ends where the device is, in steps of at most a millisecond.
/// @return steps
int move(const Mass& mass, const DevicePoint& device, double elapsed_s, double share, MassState& state) noexcept {
  const int steps = static_cast<int>(std::clamp(std::ceil(elapsed_s / kStepMost_s - 1e-6), 1.0, kStepsMost));
  const double step_s = std::min(elapsed_s / steps, kStepMost_s);
  for (int i = 1; i <= steps; ++i) {
    DevicePoint then = device;
    then.place_m -= step_s * (steps - i) * device.velocity_m_per_s;
    step(mass, then, step_s, share, state);
  }
  return steps;
}

}  // namespace

void DraggedMass::update(const Mass& told, const ModelAge& age, Nanoseconds now) noexcept {
  newest_N_ = told.force_N;
  now_ = now;
  if (coming_ && told.id == later_.id) return;
  if (told.id != reported_.id) there_ = false;
  coming_ = true;
  later_ = told;
  later_state_ = state_of(told);
  reached_ = now - time::from_seconds(age.s);
  catch_up();
  if (has_caught_up()) take_its_place();
}

void DraggedMass::take_its_place() noexcept {
  deviation_m_ = there_ ? (later_state_.place_m - state_.place_m).norm() : 0;
  reported_ = later_;
  state_ = later_state_;
  there_ = true;
  coming_ = false;
}

bool DraggedMass::stands() const noexcept {
  const auto met = std::span(reported_.contacts).first(reported_.contact_count);
  return is_the_devices_own() && reported_.body.bias_m_per_s2.isZero(0) &&
         std::ranges::all_of(met, [](const auto& contact) { return contact.met.bias_m_per_s2.isZero(0); });
}

/// Along the device's way since.
void DraggedMass::catch_up() noexcept {
  // What the ticks do not tell of: before them, or in a pause.
  const auto go_straight_to = [&](Nanoseconds time) {
    if (time <= reached_) return;
    later_state_.place_m += time::to_seconds(time - reached_) * later_state_.velocity_m_per_s;
    reached_ = time;
  };
  int steps = 0;
  for (std::size_t later = ticks_.later_than(reached_); later > 0; --later) {
    if (steps >= most_) return;
    const Tick& tick = ticks_.at(later - 1);
    go_straight_to(tick.time - time::from_seconds(tick.elapsed_s));
    steps += move(later_, tick.device, time::to_seconds(tick.time - reached_), tick.share, later_state_);
    reached_ = tick.time;
  }
  go_straight_to(now_);
}

void DraggedMass::advance(const DevicePoint& device, double elapsed_s, Nanoseconds now, double share) noexcept {
  now_ = now;
  if (!(elapsed_s > 0)) return;
  ticks_.push({.time = now, .device = device, .elapsed_s = elapsed_s, .share = share});
  if (there_) (void)move(reported_, device, elapsed_s, share, state_);
  if (coming_) catch_up();
}

}  // namespace forcebound::local_model
