#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "forcebound/device/haptic_device.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/driver/reading_times.hpp"
#include "forcebound/time/steady_clock.hpp"
#include "library/forcebound.h"

namespace forcebound::library {

/// A device of a program's callbacks. Each is called as if it could do anything but end the process: one that fails,
/// throws or takes longer than kLate is no reading, or a command that may not have arrived, so that the law gives zero
/// force, and is counted.
class CallbackDevice final : public device::HapticDevice {
 public:
  static constexpr time::Nanoseconds kLate = std::chrono::milliseconds{10};

  CallbackDevice(device::RealDevice facts, const fb_device_callbacks& callbacks);

  [[nodiscard]] const control::DeviceFacts& facts() const noexcept override { return known_.facts; }
  [[nodiscard]] bool bounds_are_identified() const noexcept override { return known_.identified; }
  [[nodiscard]] device::Safety safety() const noexcept override { return known_.safety; }
  void start() override;
  [[nodiscard]] device::Reading read(time::Nanoseconds now) noexcept override;
  void apply(time::Nanoseconds now, const control::Vector& force_N) noexcept override;
  void stop(time::Nanoseconds now) noexcept override;
  [[nodiscard]] std::optional<time::Nanoseconds> released_at() const noexcept override { return std::nullopt; }
  [[nodiscard]] bool write_failed() const noexcept override { return write_failed_; }
  [[nodiscard]] device::DeviceCounters counters() const noexcept override { return counters_; }
  [[nodiscard]] std::string_view last_error() const noexcept override { return error_; }

  /// Any thread.
  [[nodiscard]] std::uint64_t failed() const noexcept { return failed_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t late() const noexcept { return late_.load(std::memory_order_relaxed); }

 private:
  template <class Call>
  [[nodiscard]] bool done(const char* failure, Call&& call) noexcept;
  [[nodiscard]] device::Reading reading_of(const fb_reading& told, time::Nanoseconds now) noexcept;
  [[nodiscard]] device::Reading without_reading(device::Reading::Status status) const noexcept;
  [[nodiscard]] bool command(const control::Vector& force_N) noexcept;

  device::RealDevice known_;
  fb_device_callbacks callbacks_;
  control::Damping damping_;
  driver::ReadingTimes times_;
  time::SteadyClock clock_;
  bool write_failed_ = false;
  device::DeviceCounters counters_{};
  std::string_view error_{};  // texts that last
  std::atomic<std::uint64_t> failed_{0};
  std::atomic<std::uint64_t> late_{0};
};

}  // namespace forcebound::library
