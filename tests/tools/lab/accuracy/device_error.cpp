#include "tests/tools/lab/accuracy/device_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace forcebound::lab {
namespace {

/// The reference between two ticks is the straight line between theirs; before the first tick it is that one's.
Vector reference_at(std::span<const DeviceTick> ticks, Nanoseconds time) {
  const auto after = std::ranges::lower_bound(ticks, time, {}, &DeviceTick::time);
  if (after == ticks.begin()) return ticks.front().reference;
  if (after == ticks.end()) return ticks.back().reference;
  const auto before = std::prev(after);
  const double share =
      static_cast<double>((time - before->time).count()) / static_cast<double>((after->time - before->time).count());
  return before->reference + share * (after->reference - before->reference);
}

Nanoseconds least_age_of(std::span<const DeviceTick> ticks) {
  Nanoseconds least = Nanoseconds::max();
  for (const DeviceTick& tick : ticks) {
    if (tick.answered) least = std::min(least, tick.time - tick.motion_time);
  }
  return least == Nanoseconds::max() ? Nanoseconds{0} : least;
}

}  // namespace

DeviceError device_error(std::span<const DeviceTick> ticks) {
  constexpr std::size_t kParts = 4;
  DeviceError error{.least_age = least_age_of(ticks)};
  double reference_N2 = 0;
  double whole_N2 = 0;
  std::array<double, kParts> along_N2{};
  std::array<double, kParts> alone_N2{};
  for (const DeviceTick& tick : ticks) {
    const Vector zero = Vector::Zero(tick.reference.rows());
    const Vector inherent = tick.answered ? reference_at(ticks, tick.time - error.least_age) : tick.reference;
    const Vector at_motion = tick.answered ? reference_at(ticks, tick.motion_time) : zero;
    const Vector arrived = tick.answered ? tick.arrived : zero;
    const std::array<Vector, kParts> parts{arrived - at_motion, inherent - tick.reference,
                                           at_motion - inherent + tick.request - arrived, tick.applied - tick.request};
    const Vector whole = tick.applied - tick.reference;
    reference_N2 += tick.reference.squaredNorm();
    whole_N2 += whole.squaredNorm();
    for (std::size_t i = 0; i < kParts; ++i) {
      along_N2.at(i) += parts.at(i).dot(whole);
      alone_N2.at(i) += parts.at(i).squaredNorm();
    }
  }
  if (!(reference_N2 > 0)) return error;
  error.total = std::sqrt(whole_N2 / reference_N2);
  const auto part = [&](std::size_t i) {
    const double share = whole_N2 > 0 ? along_N2.at(i) / std::sqrt(whole_N2 * reference_N2) : 0;
    return DeviceError::Part{share, std::sqrt(alone_N2.at(i) / reference_N2)};
  };
  error.model = part(0);
  error.age = part(1);
  error.hold = part(2);
  error.bounding = part(3);
  return error;
}

}  // namespace forcebound::lab
