#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/client/commands/check_device/device_check.hpp"
#include "forcebound/control/reading_status.hpp"

namespace forcebound::client::commands {

using control::Vector;

/// The tip was faster than it may be; the force is zero.
class TooFast : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Nobody can tell any more where the tip goes, or it went too far; the force is zero.
class OutOfControl : public std::runtime_error {
 public:
  OutOfControl(const std::string& measured, std::string accepted)
      : std::runtime_error(measured), accepted_(std::move(accepted)) {}
  [[nodiscard]] const std::string& accepted() const noexcept { return accepted_; }

 private:
  std::string accepted_;
};

/// What the readings since the last `forget_readings` were.
struct ReadingCounts {
  std::uint64_t good = 0;
  std::uint64_t stale = 0;
  control::ReadingCounts refused{};
  std::uint64_t old = 0;  ///< latched long before they were read
  std::string last_failure{};
  std::vector<double> age_s{};  ///< of the good ones, when they were read
  Nanoseconds first_latched{0};
  Nanoseconds last_latched{0};

  /// That cannot be true, or that there are none of; what is stale aside.
  [[nodiscard]] std::uint64_t failed() const noexcept { return control::refused(refused); }
  /// Of these for the sake of the time that they tell.
  [[nodiscard]] std::uint64_t out_of_time() const noexcept {
    return refused[control::ReadingStatus::backwards] + refused[control::ReadingStatus::future];
  }
};

/// How many calls there were, and how many did not return in time.
struct CallCounts {
  std::uint64_t calls = 0;
  std::uint64_t blocked = 0;    ///< waited or computed for longer than a driver may
  std::uint64_t preempted = 0;  ///< took so long because the machine had other things to do
  Nanoseconds longest{0};       ///< of those that blocked
};

/// One push: where the device went, from its first motion on.
struct Push {
  Vector moved;                 ///< [m]
  double twice_integrated = 0;  ///< of the force, over time [N s^2]
  double moved_integrated = 0;  ///< of the way along the push [m s]
  double speed_m_per_s = 0;     ///< along the push, at its end
  double force_N = 0;           ///< at its end
  std::string too_fast{};       ///< why it ended before its time; empty: it did not
};

/// Ticks of a device: each reads it and then, unless told otherwise, commands a force.
class DeviceDriving {
 public:
  DeviceDriving(device::HapticDevice& device, Pace& pace, const DeviceCheckSettings& settings);

  void begin(const std::string& check) { check_ = check; }
  [[nodiscard]] const std::string& check() const { return check_; }
  void start();
  void stop();
  /// Neither reads nor commands for so long.
  void rest_for(double seconds) { pace_.wait_until(pace_.now() + time::from_seconds(seconds)); }
  /// @param force none: no command @throws TooFast in place of a force on a tip that is faster than it may be
  /// @throws OutOfControl in place of a force, if there was no usable reading for too long
  void tick(const std::optional<Vector>& force);
  /// Reads without a command, while the device may still hold a force. @throws as `tick`, after a stop
  void tick_letting_go();
  /// As `tick`, but commands only if this tick has no usable reading.
  void tick_while_unreadable(const Vector& force);
  /// Pushes until the device has moved so far, is too fast, or the time is over. @param ramp_s 0: at once
  struct PushSettings {
    Vector along;  ///< unit vector
    double force_N = 0;
    double ramp_s = 0.3;
    double seconds = 1;
    double way_m = 0.005;
  };
  [[nodiscard]] Push push(const PushSettings& settings);
  /// What it moves like along the lightest axis pushed so far, so that braking is not too hard for it.
  void keep_lightest(double mass_kg) { mass_kg_ = std::min(mass_kg_, mass_kg); }
  /// Opposes the motion until there is none, once it is no faster than it may be. @throws OutOfControl as `tick`
  void brake(double force_N);

  [[nodiscard]] Vector position() const { return track_.empty() ? zero() : track_.back().position; }
  [[nodiscard]] Vector velocity() const;
  [[nodiscard]] double damping_along(const Vector& along) const;
  [[nodiscard]] Vector wrench_of(const Vector& force) const;
  [[nodiscard]] Vector zero() const { return Vector::Zero(device_.facts().translations()); }
  [[nodiscard]] Nanoseconds now() { return pace_.now(); }
  [[nodiscard]] const ReadingCounts& readings() const { return readings_; }
  void forget_readings() { readings_ = {}; }
  /// Readings that failed since the beginning.
  [[nodiscard]] std::uint64_t failures() const { return failures_; }
  [[nodiscard]] const CallCounts& calls() const { return calls_; }
  [[nodiscard]] std::uint64_t commands() const { return commands_; }
  [[nodiscard]] device::DeviceCounters counters() const { return device_.counters(); }
  [[nodiscard]] const control::DeviceFacts& facts() const { return device_.facts(); }
  /// As the last reading told them.
  [[nodiscard]] std::optional<std::uint32_t> buttons() const { return buttons_; }
  [[nodiscard]] double speed_m_per_s_max() const { return settings_.speed_m_per_s_max; }

 private:
  struct Place {
    Nanoseconds latched;
    Vector position;
  };
  bool read_next();
  void command(const Vector& force);
  void timed(const char* name, const std::function<void()>& call);
  void store_reading(const device::Reading& reading, Nanoseconds now);
  [[nodiscard]] Vector velocity_since(const Place& from) const;
  [[nodiscard]] double speed_now() const;
  void expect_slow();
  [[nodiscard]] TooFast too_fast(double speed) const;
  [[nodiscard]] Nanoseconds blind_most() const;
  [[nodiscard]] bool is_blind() const { return now_ - seen_ > blind_most(); }
  [[nodiscard]] OutOfControl blind() const;

  device::HapticDevice& device_;
  Pace& pace_;
  const DeviceCheckSettings& settings_;
  std::string check_;
  Nanoseconds next_{0};
  Nanoseconds now_{0};   ///< of the tick
  Nanoseconds seen_{0};  ///< of the last tick with a usable reading
  std::deque<Place> track_{};
  control::Matrix damping_{};
  double mass_kg_ = std::numeric_limits<double>::infinity();
  ReadingCounts readings_{};
  CallCounts calls_{};
  std::uint64_t commands_ = 0;
  std::uint64_t failures_ = 0;
  std::optional<std::uint32_t> buttons_{};
};

}  // namespace forcebound::client::commands
