#include "forcebound/scene/device_path.hpp"

#include <algorithm>
#include <cmath>

namespace forcebound::scene {
namespace {

Point no_faster_than(const Point& velocity_m_per_s, double most_m_per_s) noexcept {
  const double speed = velocity_m_per_s.norm();
  return speed > most_m_per_s ? Point(velocity_m_per_s * (most_m_per_s / speed)) : velocity_m_per_s;
}

}  // namespace

Nanoseconds wrapped_difference(Nanoseconds later, Nanoseconds earlier) noexcept {
  return Nanoseconds{static_cast<std::int64_t>(static_cast<std::uint64_t>(later.count()) -
                                               static_cast<std::uint64_t>(earlier.count()))};
}

void DevicePath::Transits::add(const Transits& other) noexcept {
  least = std::min(least, other.least);
  most = std::max(most, other.most);
}

DevicePath::Transits DevicePath::transits() const noexcept {
  Transits all = now_;
  all.add(before_);
  return all;
}

void DevicePath::receive(const Motion& motion) noexcept {
  const Point position_m = motion.position_m.cwiseMax(-kFar_m).cwiseMin(kFar_m);
  if (count_ == 0) {
    played_at_ = motion.arrived;
    begin(motion, position_m);
    if (!placed_) place_at(position_m);
    aside_m_ = place_.position_m - position_m;
    return;
  }
  const Nanoseconds read = wrapped_difference(motion.read, epoch_);
  const Nanoseconds transit = wrapped_difference(motion.arrived, read);
  const Nanoseconds least = transits().least;
  if (transit > least + kJump || transit < least - kJump) {
    begin(motion, position_m);
    aside_m_ = place_.position_m - position_m;
    return;
  }
  const Knot& newest = knot(count_ - 1);
  if (read <= newest.read) return;
  const Nanoseconds newest_was = transit + (read - newest.read);
  const bool outage = newest_was > std::min(least, transit) + kDelayMost;
  add_transit({.least = transit, .most = outage ? transit : newest_was}, motion.arrived);
  const Point until_now_m = reported_at(played_).position_m;
  const Point mean_m_per_s = (position_m - newest.position_m) / time::to_seconds(read - newest.read);
  add({.read = read,
       .position_m = position_m,
       .velocity_m_per_s = no_faster_than(mean_m_per_s, kFast_m_per_s),
       .buttons = motion.buttons});
  aside_m_ += until_now_m - reported_at(played_).position_m;
}

void DevicePath::begin(const Motion& motion, const Point& position_m) noexcept {
  epoch_ = motion.read;
  first_ = 0;
  count_ = 0;
  add({.position_m = position_m, .buttons = motion.buttons});
  now_ = {.least = motion.arrived, .most = motion.arrived};
  before_ = {};
  window_began_ = motion.arrived;
  // What was played last may be from before it arrived.
  played_ = played_at_ - motion.arrived - kMargin;
}

void DevicePath::add(const Knot& newest) noexcept {
  if (count_ == kMotions) {
    first_ = (first_ + 1) % kMotions;
    --count_;
  }
  knots_[(first_ + count_) % kMotions] = newest;
  ++count_;
}

void DevicePath::add_transit(const Transits& one, Nanoseconds arrived) noexcept {
  const Nanoseconds since = arrived - window_began_;
  if (since >= kWindow) {
    before_ = since < 2 * kWindow ? now_ : Transits{};
    now_ = {};
    window_began_ = arrived;
  }
  now_.add(one);
}

const DevicePath::Place& DevicePath::play(Nanoseconds moment) noexcept {
  const Nanoseconds elapsed = moment - played_at_;
  if (count_ == 0 || elapsed <= Nanoseconds::zero()) return place_;
  played_at_ = moment;
  advance(elapsed);
  while (count_ > 1 && knot(1).read <= played_) {
    first_ = (first_ + 1) % kMotions;
    --count_;
  }
  const Point before_m = place_.position_m;
  place_ = reported_at(played_);
  ease(time::to_seconds(elapsed));
  bound_speed(before_m, time::to_seconds(elapsed));
  return place_;
}

void DevicePath::advance(Nanoseconds elapsed) noexcept {
  const Transits all = transits();
  const Nanoseconds wanted = played_at_ - std::min(all.most + kMargin, all.least + kDelayMost);
  const Nanoseconds apart = wanted - (played_ + elapsed);
  if (apart > kJump || apart < -kJump) {
    const Point until_now_m = reported_at(played_).position_m;
    played_ = wanted;
    aside_m_ += until_now_m - reported_at(played_).position_m;
    return;
  }
  const Nanoseconds most = elapsed / kSlower;
  played_ += elapsed + std::clamp(apart, -most, most);
}

/// What is played goes to where the motions have the device.
void DevicePath::ease(double elapsed_s) noexcept {
  const double left_m = aside_m_.norm();
  if (left_m > 0) {
    const double by_m = std::min(left_m * std::min(1.0, elapsed_s / kEase_s), kEase_m_per_s * elapsed_s);
    const Point step_m = aside_m_ * (by_m / left_m);
    aside_m_ -= step_m;
    place_.velocity_m_per_s -= step_m / elapsed_s;
  }
  place_.position_m += aside_m_;
}

/// Of motions that no hand makes.
void DevicePath::bound_speed(const Point& before_m, double elapsed_s) noexcept {
  const Point mean_m_per_s = (place_.position_m - before_m) / elapsed_s;
  const Point bounded_m_per_s = no_faster_than(mean_m_per_s, kFast_m_per_s);
  const Point back_m = elapsed_s * (bounded_m_per_s - mean_m_per_s);
  place_.position_m += back_m;
  aside_m_ += back_m;
  place_.velocity_m_per_s = no_faster_than(place_.velocity_m_per_s, kFast_m_per_s);
}

DevicePath::Place DevicePath::reported_at(Nanoseconds reading) const noexcept {
  std::size_t i = 0;
  while (i + 1 < count_ && knot(i + 1).read <= reading) ++i;
  const Knot& from = knot(i);
  if (reading < from.read) return {.position_m = from.position_m, .buttons = from.buttons};
  if (i + 1 < count_) {
    const Knot& to = knot(i + 1);
    const double share = time::to_seconds(reading - from.read) / time::to_seconds(to.read - from.read);
    return {.position_m = from.position_m + share * (to.position_m - from.position_m),
            .velocity_m_per_s = to.velocity_m_per_s,
            .buttons = from.buttons};
  }
  const double fades = std::exp(-time::to_seconds(reading - from.read) / kGoesOn_s);
  return {.position_m = from.position_m + kGoesOn_s * (1 - fades) * from.velocity_m_per_s,
          .velocity_m_per_s = fades * from.velocity_m_per_s,
          .buttons = from.buttons};
}

Nanoseconds DevicePath::played_before(Nanoseconds device_time) const noexcept {
  const Nanoseconds before = wrapped_difference(wrapped_difference(device_time, epoch_), played_);
  return std::clamp<Nanoseconds>(before, -kJump, kJump);
}

}  // namespace forcebound::scene
