#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string_view>
#include <thread>

#include "forcebound/device/haptic_device.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

using time::Nanoseconds;

/// Watches the thread that calls a robot's driver, from a thread of its own.
///
/// If the next tick does not begin within a period and the time for which the robot holds a torque, or kSlow, the robot
/// is stopped on this other thread, as the interface of drivers allows: a call takes too long, or the thread gets no
/// time. If none begins within kStuck, that thread is lost: it is never ended, and the rest of the process can tell so
/// and end. If it does not within kEnds of that, such as for a lock that the lost thread holds, the process is ended
/// here. A robot whose driver has crashed is lost too, and stopped already (HapticDevice::crash).
class RobotGuard {
 public:
  enum class Trouble : std::uint8_t {
    none,
    slow,     ///< in a call or without time for too long, and stopped; it may come back
    stuck,    ///< it is not waited for any longer
    crashed,  ///< its driver; it never comes back
  };
  static constexpr Nanoseconds kSlow = std::chrono::milliseconds{50};
  static constexpr Nanoseconds kStuck = std::chrono::seconds{2};
  static constexpr Nanoseconds kEnds = std::chrono::seconds{10};

  /// Both must outlive it. @param priority of its own thread, SCHED_FIFO; none: as any thread
  RobotGuard(device::HapticDevice& robot, const time::Clock& clock, std::optional<int> priority);

  /// A tick begins on that thread; the first one begins the watch. Real time.
  void store_tick_time(Nanoseconds now) noexcept { began_.store(now.count(), std::memory_order_relaxed); }
  /// There is no further tick, nor anything to watch.
  void end() noexcept { began_.store(0, std::memory_order_relaxed); }

  // Any thread.
  [[nodiscard]] Trouble trouble() const noexcept;
  /// It is stuck, or its driver has crashed.
  [[nodiscard]] bool is_lost() const noexcept { return trouble() >= Trouble::stuck; }
  /// How its driver crashed; empty: it did not.
  [[nodiscard]] std::string_view crash() const noexcept { return robot_.crash(); }
  /// Whether the driver's stop returned after the latest trouble.
  [[nodiscard]] bool stopped() const noexcept { return stopped_; }

 private:
  void run(const std::stop_token& stopping);
  void stop_robot();

  [[nodiscard]] Nanoseconds since_tick() const noexcept;

  device::HapticDevice& robot_;
  const time::Clock& clock_;
  Nanoseconds limit_;
  std::optional<int> priority_;
  std::atomic<std::int64_t> began_{0};  ///< when the latest tick did [ns]; 0: there are none
  std::atomic<bool> stopped_{false};
  std::jthread thread_;  // last, so that it ends before the members that it reads
};

}  // namespace forcebound::server
