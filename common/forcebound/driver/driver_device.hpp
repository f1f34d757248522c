#pragma once

#include <memory>
#include <optional>
#include <string>

#include "forcebound/device/haptic_device.hpp"
#include "forcebound/device/load_device.hpp"
#include "forcebound/driver/opened_driver.hpp"
#include "forcebound/driver/reading_times.hpp"

namespace forcebound::driver {

using control::Matrix;
using control::Vector;
using time::Nanoseconds;

/// A device behind a driver of forcebound_device.h.
///
/// What a driver returns is checked before it is used: numbers that are not finite, stamps that run backwards or lie in
/// the future, and a driver that throws are readings that are refused, and a reading that is not new is stale.
/// Without a usable reading the law commands no force. An orientation or gripper opening that cannot be true is absent
/// from the reading, and counted (control::sound); the rest of that reading counts.
class DriverDevice final : public device::HapticDevice {
 public:
  /// Opens it. @param own facts and limits in place of those that the driver tells; none: the driver's
  /// @throws std::runtime_error in one line: what the driver says, or what is wrong with its facts
  DriverDevice(std::shared_ptr<const DriverLibrary> library, const DriverRequest& request,
               std::optional<device::RealDevice> own = std::nullopt);

  /// Before start. @throws std::invalid_argument as device::at_tick_rate, or above the rate that the driver tells
  void run_at(double rate_Hz);

  [[nodiscard]] const control::DeviceFacts& facts() const noexcept override { return facts_; }
  [[nodiscard]] bool bounds_are_identified() const noexcept override { return identified_; }
  [[nodiscard]] std::string facts_in_words() const override;
  [[nodiscard]] device::Safety safety() const noexcept override { return safety_; }
  void start() override { opened_.start(); }
  device::Reading read(Nanoseconds now) noexcept override;
  void apply(Nanoseconds now, const Vector& force_N) noexcept override;
  void stop(Nanoseconds /*now*/) noexcept override { (void)opened_.stop(); }
  [[nodiscard]] std::optional<Nanoseconds> effective_at() const noexcept override { return effective_at_; }
  [[nodiscard]] bool write_failed() const noexcept override { return write_failed_; }
  [[nodiscard]] std::optional<Nanoseconds> released_at() const noexcept override { return released_at_; }
  [[nodiscard]] device::DeviceCounters counters() const noexcept override { return counters_; }
  [[nodiscard]] std::string_view last_error() const noexcept override { return opened_.last_error(); }
  [[nodiscard]] std::string_view crash() const noexcept override { return crash_in_words(); }

 private:
  [[nodiscard]] const forcebound_driver& driver() const noexcept { return opened_.functions(); }
  [[nodiscard]] device::Reading without_reading(device::Reading::Status status) noexcept;
  [[nodiscard]] device::Reading reading_of(const forcebound_reading& told, Nanoseconds now) noexcept;
  void store_reports(const forcebound_reading& told) noexcept;

  OpenedDriver opened_;
  control::DeviceFacts facts_;
  device::Safety safety_{};
  bool identified_ = true;
  std::string guessed_by_ = "the driver";
  control::Damping damping_ = control::Damping::of_axis(1);
  ReadingTimes times_;
  std::optional<Nanoseconds> effective_at_{};
  std::optional<Nanoseconds> released_at_{};
  bool write_failed_ = false;
  device::DeviceCounters counters_{};
};

}  // namespace forcebound::driver
