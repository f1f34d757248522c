#include "forcebound/record/displayed_stiffness.hpp"

#include <algorithm>
#include <cmath>

namespace forcebound::record {

std::optional<double> DisplayedStiffness::on_tick(const TickRecord& tick) noexcept {
  const double depth_m = tick.penetration_m;
  at_rest_ = false;
  if (!(depth_m > 0)) {
    since_.reset();
    return std::nullopt;
  }
  if (!since_) {
    since_ = tick.time;
    slots_.fill({});
    previous_m_ = depth_m;
  }
  const std::int64_t number = tick.time.count() / kSlot_ns;
  add(number, depth_m);
  // If ticks are further apart than the window, compare with the previous one.
  double moved_m = change_m(number, depth_m);
  if (tick.interval > kWindow) moved_m = std::max(moved_m, std::abs(depth_m - previous_m_));
  previous_m_ = depth_m;
  const double allowed_m = kSpeed_m_per_s * time::to_seconds(std::max(kWindow, tick.interval));
  at_rest_ = tick.time - *since_ >= kWindow && moved_m <= allowed_m;
  if (!at_rest_ || !(depth_m > depth_m_min_)) return std::nullopt;
  return tick.displayed_N / depth_m;
}

void DisplayedStiffness::add(std::int64_t number, double depth_m) noexcept {
  Slot& slot = slots_[static_cast<std::size_t>(number) % kSlots];
  if (slot.number != number) slot = {number, depth_m, depth_m};
  slot.least_m = std::min(slot.least_m, depth_m);
  slot.most_m = std::max(slot.most_m, depth_m);
}

double DisplayedStiffness::change_m(std::int64_t number, double depth_m) const noexcept {
  double least_m = depth_m;
  double most_m = depth_m;
  for (const Slot& slot : slots_) {
    if (slot.number <= number - static_cast<std::int64_t>(kSlots)) continue;
    least_m = std::min(least_m, slot.least_m);
    most_m = std::max(most_m, slot.most_m);
  }
  return most_m - least_m;
}

}  // namespace forcebound::record
