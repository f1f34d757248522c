#pragma once

#include <atomic>
#include <chrono>
#include <semaphore>
#include <string_view>
#include <thread>

#include "forcebound/client/commands/check_device/check_progress.hpp"
#include "forcebound/client/commands/check_device/device_checks.hpp"
#include "forcebound/device/haptic_device.hpp"

namespace forcebound::client::commands {

/// How long a call of a driver may take before it counts as one that does not return.
inline constexpr std::chrono::seconds kReturnsWithin{2};  ///< read, command, stop
inline constexpr std::chrono::seconds kStartsWithin{35};  ///< open and start: what the interface allows, and some more
inline constexpr std::chrono::seconds kClosesWithin{5};   ///< likewise
inline constexpr std::chrono::milliseconds kStopMost{
    100};  ///< before a device that holds a force for longer is stopped

/// Watches the calls of a driver in a process that was made for it, from a thread of its own.
///
/// If a call takes longer than the device holds a force, at most kStopMost, the device is stopped, on another thread,
/// as the interface of drivers allows; but not in open and start, in which a device may be finding its zero. If the
/// call does not return at all, the device is stopped likewise and the process ends; the progress tells why. It ends
/// even if stop does not return. Likewise where the driver has crashed, and was stopped for that
/// (driver::catch_crashes).
class CallWatch final : public CallListener {
 public:
  /// One in a process, which has no other threads yet. `progress` must outlive the process.
  CallWatch(CheckProgress& progress, std::chrono::seconds all_within);
  ~CallWatch() override;
  CallWatch(const CallWatch&) = delete;
  CallWatch& operator=(const CallWatch&) = delete;

  /// From now on it is this device that is stopped; null: none. Not a simulated one.
  void guard(device::HapticDevice* device) noexcept;

  /// Waits for ever once the driver has crashed.
  void begin(const std::string& check, const char* call) override;
  void end() override { progress_.called_ns = 0; }

 private:
  void watch(const std::stop_token& ending);
  void stop_when_asked(const std::stop_token& ending);
  [[noreturn]] void end_with(std::string_view crash);
  [[noreturn]] void end_process();

  CheckProgress& progress_;
  std::int64_t all_until_ns_;
  std::atomic<device::HapticDevice*> device_{nullptr};
  std::int64_t hold_ns_ = std::chrono::nanoseconds(kStopMost).count();  ///< of the thread that calls
  std::atomic<std::int64_t> within_ns_{0};                              ///< of the call in progress
  std::atomic<std::int64_t> stop_after_ns_{0};                          ///< likewise
  std::atomic<std::uint64_t> stops_{0};
  std::counting_semaphore<> asked_{0};
  std::jthread stopper_;
  std::jthread watcher_;
};

}  // namespace forcebound::client::commands
