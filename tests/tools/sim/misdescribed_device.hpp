#pragma once

#include "forcebound/device/haptic_device.hpp"

namespace forcebound::sim {

/// A simulated device of which a law is told other facts than the true ones: it moves as it truly does, and all that
/// says something of it, the damping of each reading included, is as told.
class MisdescribedDevice final : public device::HapticDevice {
 public:
  /// @param device must outlive it
  MisdescribedDevice(device::HapticDevice& device, control::DeviceFacts told)
      : device_(device), described_(std::move(told)), damping_(control::Damping::from_matrix(described_.damping)) {}

  [[nodiscard]] const control::DeviceFacts& facts() const noexcept override { return described_; }
  [[nodiscard]] bool is_simulated() const noexcept override { return true; }
  [[nodiscard]] device::Safety safety() const noexcept override { return device_.safety(); }
  device::Reading read(device::Nanoseconds now) noexcept override {
    device::Reading reading = device_.read(now);
    if (!described_.cartesian) damping_ = control::Damping::from_joints(reading.jacobian, described_.damping);
    reading.damping = &damping_;
    return reading;
  }
  void apply(device::Nanoseconds now, const device::Vector& force_N) noexcept override { device_.apply(now, force_N); }
  [[nodiscard]] std::optional<device::Nanoseconds> effective_at() const noexcept override {
    return device_.effective_at();
  }
  [[nodiscard]] bool write_failed() const noexcept override { return device_.write_failed(); }
  [[nodiscard]] std::optional<device::Nanoseconds> released_at() const noexcept override {
    return device_.released_at();
  }
  [[nodiscard]] std::optional<control::PassivityAudit> audit() const noexcept override { return device_.audit(); }
  [[nodiscard]] device::DeviceCounters counters() const noexcept override { return device_.counters(); }

 private:
  device::HapticDevice& device_;
  control::DeviceFacts described_;
  control::Damping damping_;
};

}  // namespace forcebound::sim
