#include "tests/tools/lab/check_device/device_driving.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "forcebound/time/clock.hpp"

namespace forcebound::lab {
namespace {

constexpr Nanoseconds kCallMost = std::chrono::microseconds{200};  // of forcebound_device.h
constexpr std::size_t kPlaces = 10;                                // over which a velocity is measured
constexpr double kStill_m_per_s = 0.005;
constexpr double kOldPeriods = 20;

}  // namespace

DeviceDriving::DeviceDriving(device::HapticDevice& device, Pace& pace, const DeviceCheckSettings& settings)
    : device_(device), pace_(pace), settings_(settings), damping_(device.facts().damping) {}

void DeviceDriving::timed(const char* name, const std::function<void()>& call) {
  if (settings_.tell) settings_.tell(check_, name);
  const CallCost cost = pace_.cost_of(call);
  ++calls_.calls;
  if (cost.wall <= kCallMost) return;
  // A call that waits gives the processor away; one that was interrupted by other programs does neither that nor uses
  // its time.
  if (cost.waits == 0 && cost.processor <= kCallMost) {
    ++calls_.preempted;
    return;
  }
  ++calls_.blocked;
  calls_.longest = std::max(calls_.longest, cost.wall);
}

void DeviceDriving::start() {
  if (settings_.tell) settings_.tell(check_, "start");
  device_.start();
  track_.clear();
  next_ = pace_.now();
}

void DeviceDriving::stop() {
  timed("stop", [this] { device_.stop(pace_.now()); });
}

void DeviceDriving::tick(const std::optional<Vector>& force) {
  if (settings_.cancelled && settings_.cancelled()) throw std::runtime_error("cancelled; the force is zero");
  next_ = std::max(next_ + time::from_seconds(facts().period_s), pace_.now());
  pace_.wait_until(next_);
  const Nanoseconds now = pace_.now();
  device::Reading reading;
  timed("read", [&] { reading = device_.read(now); });
  note(reading, now);
  if (force) {
    timed("command", [&] { device_.apply(now, *force); });
  }
}

void DeviceDriving::note(const device::Reading& reading, Nanoseconds now) {
  if (reading.status == device::Reading::Status::stale) {
    ++readings_.stale;
    return;
  }
  if (!device::is_usable(reading, facts().degrees_of_freedom(), facts().joints())) {
    ++readings_.failed;
    readings_.last_failure = std::string(device_.last_error());
    return;
  }
  ++readings_.good;
  if (time::to_seconds(now - reading.latched) > kOldPeriods * facts().period_s + facts().uncertainty.stamp_s.most) {
    ++readings_.old;
  }
  damping_ = reading.damping->matrix();
  track_.push_back({reading.latched, reading.position});
  if (track_.size() > kPlaces) track_.pop_front();
}

Vector DeviceDriving::velocity() const {
  if (track_.size() < 2) return zero();
  const double seconds = time::to_seconds(track_.back().latched - track_.front().latched);
  if (!(seconds > 0)) return zero();
  return (track_.back().position - track_.front().position) / seconds;
}

double DeviceDriving::damping_along(const Vector& along) const { return along.dot(damping_ * along); }

Push DeviceDriving::push(const PushSettings& settings) {
  const Vector from = position();
  const Nanoseconds begin = pace_.now();
  Nanoseconds before = begin;
  Push push{.moved = zero()};
  double impulse_N_s = 0;
  double force_N = 0;
  while (time::to_seconds(before - begin) < settings.seconds && push.moved.norm() < settings.way_m) {
    const Nanoseconds now = pace_.now();
    const double step_s = time::to_seconds(now - before);
    before = now;
    impulse_N_s += step_s * force_N;
    push.twice_integrated += step_s * impulse_N_s;
    push.moved_integrated += step_s * settings.along.dot(push.moved);
    const double share = settings.ramp_s > 0 ? std::min(1.0, time::to_seconds(now - begin) / settings.ramp_s) : 1;
    force_N = share * settings.force_N;
    tick(force_N * settings.along);
    push.moved = position() - from;
  }
  push.speed_m_per_s = settings.along.dot(velocity());
  return push;
}

void DeviceDriving::brake(double force_N) {
  constexpr int kTicks_max = 600;
  constexpr double kFull_m_per_s = 0.5;
  for (int ticks = 0; ticks < kTicks_max; ++ticks) {
    const Vector speed = velocity();
    if (ticks > 20 && speed.norm() < kStill_m_per_s) break;
    Vector force = -force_N / kFull_m_per_s * speed;
    if (force.norm() > force_N) force *= force_N / force.norm();
    tick(force);
  }
  for (int ticks = 0; ticks < 20; ++ticks) tick(zero());
}

}  // namespace forcebound::lab
