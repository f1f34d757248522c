#pragma once

#include <atomic>
#include <cstdint>
#include <stop_token>
#include <thread>

#include "forcebound/device/haptic_device.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::client {

/// Stops a device whose tick does not run any more: a thread that looks whether it has been told of a tick within the
/// time that the device holds a force, and otherwise commands zero force, once for each such pause.
///
/// By then the device layer lets go of the force anyway, where its facts say so; this is for one that does not do as it
/// promises. For devices that are not simulated, of which `stop` may be called on any thread.
class Watchdog {
 public:
  /// Both must outlive it. @param limit longest time without a tick
  Watchdog(device::HapticDevice& device, const time::Clock& clock, time::Nanoseconds limit);

  /// A tick has run. Any thread; real time.
  void store_tick_time(time::Nanoseconds now) noexcept { ticked_.store(now.count(), std::memory_order_relaxed); }

  /// There will be no more ticks.
  void rest() noexcept { ticked_.store(0, std::memory_order_relaxed); }

  /// Whether it is in a call of the device's `stop`, which may not return either.
  [[nodiscard]] bool is_stopping() const noexcept { return stopping_; }

  /// How often it stopped the device.
  [[nodiscard]] std::uint64_t stops() const noexcept { return stops_; }

 private:
  void run(const std::stop_token& stopping);

  device::HapticDevice& device_;
  const time::Clock& clock_;
  time::Nanoseconds limit_;
  std::atomic<std::int64_t> ticked_{0};  ///< [ns]; 0: not yet, or no more
  std::atomic<bool> stopping_{false};
  std::atomic<std::uint64_t> stops_{0};
  std::jthread thread_;  // last, so that it ends before the members that it reads
};

}  // namespace forcebound::client
