#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "tests/tools/lab/check_device/device_checks.hpp"

namespace forcebound::lab {

using control::Vector;

/// What the readings since the last `clear` were.
struct ReadingCounts {
  std::uint64_t good = 0;
  std::uint64_t stale = 0;
  std::uint64_t failed = 0;
  std::uint64_t old = 0;  ///< latched long before they were read
  std::string last_failure{};
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
};

/// Ticks of a device: each reads it and then, unless told otherwise, commands a force.
class DeviceDriving {
 public:
  DeviceDriving(device::HapticDevice& device, Pace& pace, const DeviceCheckSettings& settings);

  void begin(const std::string& check) { check_ = check; }
  void start();
  void stop();
  /// Neither reads nor commands for so long.
  void rest_for(double seconds) { pace_.wait_until(pace_.now() + time::from_seconds(seconds)); }
  /// @param force none: no command
  void tick(const std::optional<Vector>& force);
  /// Pushes until the device has moved so far or the time is over. @param ramp_s 0: at once
  struct PushSettings {
    Vector along;  ///< unit vector
    double force_N = 0;
    double ramp_s = 0.3;
    double seconds = 1;
    double way_m = 0.005;
  };
  [[nodiscard]] Push push(const PushSettings& settings);
  /// Opposes the motion until there is none.
  void brake(double force_N);

  [[nodiscard]] Vector position() const { return track_.empty() ? zero() : track_.back().position; }
  [[nodiscard]] Vector velocity() const;
  [[nodiscard]] double damping_along(const Vector& along) const;
  [[nodiscard]] Vector zero() const { return Vector::Zero(device_.facts().degrees_of_freedom()); }
  [[nodiscard]] Nanoseconds now() { return pace_.now(); }
  [[nodiscard]] const ReadingCounts& readings() const { return readings_; }
  void forget_readings() { readings_ = {}; }
  [[nodiscard]] const CallCounts& calls() const { return calls_; }
  [[nodiscard]] const control::DeviceFacts& facts() const { return device_.facts(); }

 private:
  struct Place {
    Nanoseconds latched;
    Vector position;
  };
  void timed(const char* name, const std::function<void()>& call);
  void note(const device::Reading& reading, Nanoseconds now);

  device::HapticDevice& device_;
  Pace& pace_;
  const DeviceCheckSettings& settings_;
  std::string check_;
  Nanoseconds next_{0};
  std::deque<Place> track_{};
  control::Matrix damping_{};
  ReadingCounts readings_{};
  CallCounts calls_{};
};

}  // namespace forcebound::lab
