#pragma once

#include <signal.h>
#include <sys/types.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <thread>

#include "forcebound/device/haptic_device.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

using time::Nanoseconds;

/// Watches the thread that calls a robot's driver, from a thread of its own.
///
/// If the next tick does not begin within a period and the time for which the robot holds a torque, or kSlow, the robot
/// is stopped on this other thread, as the interface of drivers allows: a call takes too long, or the thread gets no
/// time. If none begins within kStuck, or the driver crashes, that thread is lost: it is never ended, the robot is
/// stopped likewise, and the rest of the process can tell so and end. If it does not within kEnds of that, such as for
/// a lock that the lost thread holds, the process is ended here. A crash in any other thread stops the robot too,
/// before it ends the process as any crash does; but not one by too deep a recursion there, which only the loop's
/// thread has a spare stack for.
///
/// One at a time in a process.
class RobotGuard {
 public:
  enum class Trouble : std::uint8_t {
    none,
    slow,     ///< in a call or without time for too long, and stopped; it may come back
    stuck,    ///< it is not waited for any longer
    crashed,  ///< it never comes back
  };
  static constexpr Nanoseconds kSlow = std::chrono::milliseconds{50};
  static constexpr Nanoseconds kStuck = std::chrono::seconds{2};
  /// So long after a crash the robot's stop is not waited for any longer.
  static constexpr Nanoseconds kStopMost = std::chrono::seconds{1};
  static constexpr Nanoseconds kEnds = std::chrono::seconds{10};

  /// Both must outlive it. @param priority of its own thread, SCHED_FIFO; none: as any thread
  RobotGuard(device::HapticDevice& robot, const time::Clock& clock, std::optional<int> priority);
  ~RobotGuard();
  RobotGuard(const RobotGuard&) = delete;
  RobotGuard& operator=(const RobotGuard&) = delete;

  /// On the thread that calls the driver, once.
  void watch_this_thread();

  /// A tick begins on that thread; the first one begins the watch. Real time.
  void note_tick(Nanoseconds now) noexcept { began_.store(now.count(), std::memory_order_relaxed); }
  /// There is no further tick, nor anything to watch. On the watched thread, before it ends.
  void end() noexcept;

  // Any thread.
  [[nodiscard]] Trouble trouble() const noexcept;
  /// It is stuck; or has crashed, and the robot was stopped or its stop does not return.
  [[nodiscard]] bool is_lost() const noexcept;
  /// Of a crash; 0: there was none.
  [[nodiscard]] int signal() const noexcept { return signal_; }
  /// Whether the driver's stop returned after the latest trouble.
  [[nodiscard]] bool stopped() const noexcept { return stopped_; }

 private:
  static constexpr std::size_t kStackBytes = std::size_t{1} << 16U;

  static void note_crash(int number);
  void run(const std::stop_token& stopping);
  void stop_robot();

  [[nodiscard]] Nanoseconds since_tick() const noexcept;

  device::HapticDevice& robot_;
  const time::Clock& clock_;
  Nanoseconds limit_;
  std::optional<int> priority_;
  std::atomic<pid_t> loop_thread_{0};
  std::atomic<std::int64_t> began_{0};  ///< when the latest tick did [ns]; 0: there are none
  std::atomic<int> signal_{0};
  std::atomic<bool> dying_{false};  ///< by a crash in another thread
  std::atomic<bool> stopped_{false};
  std::atomic<bool> stopped_after_crash_{false};
  std::unique_ptr<std::array<std::byte, kStackBytes>> stack_;  ///< for a crash by too deep a recursion
  stack_t stack_before_{};                                     ///< of the loop's thread, which may end with it
  std::jthread thread_;                                        // last, so that it ends before the members that it reads
};

}  // namespace forcebound::server
