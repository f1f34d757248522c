#include "forcebound/client/commands/check_device/device_driving.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "forcebound/control/wrench.hpp"
#include "forcebound/device/command_times.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client::commands {
namespace {

constexpr Nanoseconds kCallMost = std::chrono::microseconds{200};  // of forcebound_device.h
constexpr std::size_t kPlaces = 10;                                // over which a velocity is measured
constexpr double kPeriodsNow = 1.5;                                // over which the speed of the moment is, at least
constexpr double kStill_m_per_s = 0.005;
constexpr double kOldPeriods = 20;
constexpr Nanoseconds kBlindMost = std::chrono::milliseconds{20};
constexpr double kBlindPeriods = 3;  // of a slow device

}  // namespace

DeviceDriving::DeviceDriving(device::HapticDevice& device, Pace& pace, const DeviceCheckSettings& settings)
    : device_(device), pace_(pace), settings_(settings), damping_(device.facts().damping) {}

void DeviceDriving::timed(const char* name, const std::function<void()>& call) {
  if (settings_.calls != nullptr) settings_.calls->begin(check_, name);
  const CallCost cost = pace_.cost_of(call);
  if (settings_.calls != nullptr) settings_.calls->end();
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
  if (settings_.calls != nullptr) settings_.calls->begin(check_, "start");
  device_.start();
  if (settings_.calls != nullptr) settings_.calls->end();
  track_.clear();
  next_ = pace_.now();
}

void DeviceDriving::stop() {
  timed("stop", [this] { device_.stop(pace_.now()); });
}

void DeviceDriving::tick(const std::optional<Vector>& force) {
  (void)read_next();
  if (!force) return;
  if (force->norm() > 0 && is_blind()) {
    command(zero());
    throw blind();
  }
  command(*force);
}

void DeviceDriving::tick_letting_go() {
  (void)read_next();
  if (is_blind()) {
    stop();
    throw blind();
  }
  const double speed = speed_now();
  if (speed <= settings_.speed_m_per_s_max) return;
  stop();
  throw too_fast(speed);
}

void DeviceDriving::tick_while_unreadable(const Vector& force) {
  if (!read_next()) command(force);
}

/// At the next tick. @returns whether it is usable
bool DeviceDriving::read_next() {
  if (settings_.cancelled && settings_.cancelled()) throw std::runtime_error("cancelled; the force is zero");
  next_ = std::max(next_ + time::from_seconds(facts().period_s), pace_.now());
  pace_.wait_until(next_);
  now_ = pace_.now();
  device::Reading read;
  timed("read", [&] { read = device_.read(now_); });
  // As the client does.
  const device::Reading reading = device::usable_or_lost(read, facts(), now_, std::max(now_, pace_.now()));
  store_reading(reading, now_);
  return reading.status == device::Reading::Status::ok;
}

void DeviceDriving::command(const Vector& force) {
  if (force.norm() > 0) expect_slow();
  ++commands_;
  timed("command", [&] { device_.apply(now_, wrench_of(force)); });
}

void DeviceDriving::expect_slow() {
  const double speed = speed_now();
  if (speed <= settings_.speed_m_per_s_max) return;
  ++commands_;
  timed("command", [&] { device_.apply(now_, wrench_of(zero())); });
  throw too_fast(speed);
}

TooFast DeviceDriving::too_fast(double speed) const {
  return TooFast("the tip was faster than " + text::rounded(settings_.speed_m_per_s_max) + " m/s (--speed), " +
                 text::rounded(speed) + " m/s: the force is zero");
}

Nanoseconds DeviceDriving::blind_most() const {
  return std::max(kBlindMost, time::from_seconds(kBlindPeriods * facts().period_s));
}

OutOfControl DeviceDriving::blind() const {
  const auto ms = [](Nanoseconds time) { return text::rounded(1e3 * time::to_seconds(time)) + " ms"; };
  return OutOfControl("no usable reading for " + ms(now_ - seen_) + " while there was a force: the force is zero",
                      "one at least each " + ms(blind_most()));
}

void DeviceDriving::store_reading(const device::Reading& reading, Nanoseconds now) {
  if (reading.status == device::Reading::Status::stale) {
    ++readings_.stale;
    return;
  }
  if (reading.status != device::Reading::Status::ok) {
    ++readings_.refused[reading.status];
    ++failures_;
    const bool by_device = reading.status == device::Reading::Status::failed;
    readings_.last_failure = by_device ? device_.last_error() : control::why(reading.status);
    return;
  }
  seen_ = now;
  if (readings_.good == 0) readings_.first_latched = reading.latched;
  readings_.last_latched = reading.latched;
  ++readings_.good;
  const double age_s = time::to_seconds(now - reading.latched);
  readings_.age_s.push_back(age_s);
  if (age_s > kOldPeriods * facts().period_s + facts().uncertainty.stamp_s.most) ++readings_.old;
  buttons_ = reading.handle.buttons;
  damping_ = reading.damping->matrix();
  track_.push_back({reading.latched, reading.position});
  if (track_.size() > kPlaces) track_.pop_front();
}

Vector DeviceDriving::velocity_since(const Place& from) const {
  const double seconds = time::to_seconds(track_.back().latched - from.latched);
  if (!(seconds > 0)) return zero();
  return (track_.back().position - from.position) / seconds;
}

Vector DeviceDriving::velocity() const { return track_.empty() ? zero() : velocity_since(track_.front()); }

double DeviceDriving::speed_now() const {
  // Readings that follow each other closely would tell the encoder's rounding.
  const Nanoseconds apart = time::from_seconds(kPeriodsNow * facts().period_s);
  const auto from = std::find_if(track_.rbegin(), track_.rend(),
                                 [&](const Place& place) { return track_.back().latched - place.latched >= apart; });
  return from == track_.rend() ? 0 : velocity_since(*from).norm();
}

double DeviceDriving::damping_along(const Vector& along) const {
  const Vector with_rotations = wrench_of(along);
  return with_rotations.dot(damping_ * with_rotations);
}

/// Forces alone: what turns is not pushed.
Vector DeviceDriving::wrench_of(const Vector& force) const {
  return control::wrench_of(force, Eigen::Vector3d::Zero(), facts().rotations);
}

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
    try {
      tick(force_N * settings.along);
    } catch (const TooFast& why) {
      push.too_fast = why.what();
    }
    push.moved = position() - from;
    if (!push.too_fast.empty()) break;
  }
  push.speed_m_per_s = settings.along.dot(velocity());
  push.force_N = force_N;
  return push;
}

void DeviceDriving::brake(double force_N) {
  constexpr int kTicks_max = 600;
  constexpr double kFull_m_per_s = 0.5;
  // The velocity is one of half as long ago as it is measured over: a force that stops it faster would shake it.
  const double window_s = static_cast<double>(kPlaces) * facts().period_s;
  const double damping = std::min(force_N / kFull_m_per_s, mass_kg_ / (2 * window_s));
  for (int ticks = 0; ticks < kTicks_max; ++ticks) {
    const Vector speed = velocity();
    if (ticks > 20 && speed.norm() < kStill_m_per_s) break;
    Vector force = -damping * speed;
    if (force.norm() > force_N) force *= force_N / force.norm();
    try {
      tick(force);
    } catch (const TooFast&) {  // no force until it has slowed down by itself
    }
  }
  for (int ticks = 0; ticks < 20; ++ticks) tick(zero());
}

}  // namespace forcebound::client::commands
