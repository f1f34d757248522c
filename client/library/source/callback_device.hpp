#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "forcebound/device/haptic_device.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/driver/reading_times.hpp"
#include "library/forcebound.h"
#include "library/source/callback_counts.hpp"

namespace forcebound::library {

/// A device of a program's callbacks. One that fails, throws or is late is no reading, or a command that may not have
/// arrived, so that the law gives zero force, and is counted.
class CallbackDevice final : public device::HapticDevice {
 public:
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
  [[nodiscard]] const CallbackCounts& calls() const noexcept { return calls_; }

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
  CallbackCounts calls_;
  bool write_failed_ = false;
  device::DeviceCounters counters_{};
  std::string_view error_{};  // texts that last
};

}  // namespace forcebound::library
