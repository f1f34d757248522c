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

constexpr std::size_t kErrorParts = 5;
using ErrorParts = std::array<Vector, kErrorParts>;

/// Of a force that the server computed: model, extrapolation, age, hold, bounding.
ErrorParts parts_of_held(std::span<const DeviceTick> ticks, const DeviceTick& tick, Nanoseconds least_age) {
  const Vector zero = Vector::Zero(tick.reference.rows());
  const Vector inherent = tick.answered ? reference_at(ticks, tick.time - least_age) : tick.reference;
  const Vector at_motion = tick.answered ? reference_at(ticks, tick.motion_time) : zero;
  const Vector arrived = tick.answered ? tick.arrived : zero;
  return {arrived - at_motion, zero, inherent - tick.reference, at_motion - inherent + tick.request - arrived,
          tick.applied - tick.request};
}

/// The same of one that was computed at the client, at least in part.
ErrorParts parts_of_rendered(const DeviceTick& tick) {
  const Vector zero = Vector::Zero(tick.reference.rows());
  const Vector own = tick.own.rows() > 0 ? tick.own : tick.reference;
  const Vector beside = tick.request - own;
  const bool held_too = tick.rendering == record::ForceOrigin::both;
  return {own - tick.reference, held_too ? zero : beside, zero, held_too ? beside : zero, tick.applied - tick.request};
}

}  // namespace

DeviceError device_error(std::span<const DeviceTick> ticks) {
  DeviceError error{.least_age = least_age_of(ticks)};
  double reference_N2 = 0;
  double whole_N2 = 0;
  std::array<double, kErrorParts> along_N2{};
  std::array<double, kErrorParts> alone_N2{};
  for (const DeviceTick& tick : ticks) {
    const ErrorParts parts = tick.rendering == record::ForceOrigin::held ? parts_of_held(ticks, tick, error.least_age)
                                                                         : parts_of_rendered(tick);
    const Vector whole = tick.applied - tick.reference;
    reference_N2 += tick.reference.squaredNorm();
    whole_N2 += whole.squaredNorm();
    for (std::size_t i = 0; i < kErrorParts; ++i) {
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
  error.extrapolation = part(1);
  error.age = part(2);
  error.hold = part(3);
  error.bounding = part(4);
  return error;
}

}  // namespace forcebound::lab
