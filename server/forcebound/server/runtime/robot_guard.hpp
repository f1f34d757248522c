#pragma once

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
/// If a tick takes longer than the robot holds a torque, and kSlow, the robot is stopped on this other thread, as the
/// interface of drivers allows. If it does not return within kStuck, or the driver crashes in it, that thread is lost:
/// it is never ended, the robot is stopped likewise, and the rest of the process can tell so and end. A crash in any
/// other thread stops the robot too, before it ends the process as any crash does.
///
/// One at a time in a process.
class RobotGuard {
 public:
  enum class Trouble : std::uint8_t {
    none,
    slow,     ///< in a call for too long, and stopped; it may come back
    stuck,    ///< it is not waited for any longer
    crashed,  ///< it never comes back
  };
  static constexpr Nanoseconds kSlow = std::chrono::milliseconds{50};
  static constexpr Nanoseconds kStuck = std::chrono::seconds{2};

  /// Both must outlive it. @param priority of its own thread, SCHED_FIFO; none: as any thread
  RobotGuard(device::HapticDevice& robot, const time::Clock& clock, std::optional<int> priority);
  ~RobotGuard();
  RobotGuard(const RobotGuard&) = delete;
  RobotGuard& operator=(const RobotGuard&) = delete;

  /// On the thread that calls the driver, once.
  void watch_this_thread();

  /// Around each tick, on that thread. Real time.
  void begin(Nanoseconds now) noexcept { began_.store(now.count(), std::memory_order_relaxed); }
  void end() noexcept { began_.store(0, std::memory_order_relaxed); }

  // Any thread.
  [[nodiscard]] Trouble trouble() const noexcept;
  [[nodiscard]] bool is_lost() const noexcept { return trouble() >= Trouble::stuck; }
  /// Of a crash; 0: there was none.
  [[nodiscard]] int signal() const noexcept { return signal_; }
  /// Whether the driver's stop returned after the latest trouble.
  [[nodiscard]] bool stopped() const noexcept { return stopped_; }

 private:
  static constexpr std::size_t kStackBytes = std::size_t{1} << 16U;

  static void note_crash(int number);
  void run(const std::stop_token& stopping);
  void stop_robot();

  device::HapticDevice& robot_;
  const time::Clock& clock_;
  Nanoseconds limit_;
  std::optional<int> priority_;
  std::atomic<pid_t> calls_{0};         ///< the thread that calls
  std::atomic<std::int64_t> began_{0};  ///< of the tick in progress [ns]; 0: none is
  std::atomic<int> signal_{0};
  std::atomic<bool> dying_{false};  ///< by a crash in another thread
  std::atomic<bool> stopped_{false};
  std::unique_ptr<std::array<std::byte, kStackBytes>> stack_;  ///< for a crash by too deep a recursion
  std::jthread thread_;                                        // last, so that it ends before the members that it reads
};

}  // namespace forcebound::server
