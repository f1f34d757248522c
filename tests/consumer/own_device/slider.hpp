#pragma once

#include <forcebound/device/haptic_device.hpp>

/// A motorised slider on a bus of its own: all that Forcebound needs of a device.
class Slider final : public forcebound::device::HapticDevice {
 public:
  using Vector = forcebound::device::Vector;
  using Nanoseconds = forcebound::device::Nanoseconds;

  Slider() {
    facts_ = {.name = "slider",
              .damping = Vector::Constant(1, 5),
              .friction = Vector::Zero(1),
              .encoder_step = Vector::Constant(1, 1e-5),
              .actuator_step = Vector::Zero(1),
              .force_N_max = 8,
              .releases = false};
    damping_ = forcebound::control::Damping::from_matrix(facts_.damping);
  }

  const forcebound::control::DeviceFacts& facts() const noexcept override { return facts_; }
  void start() override { bus.powered = true; }
  forcebound::device::Reading read(Nanoseconds now) noexcept override {
    ++bus.readings;
    const Vector at = Vector::Constant(1, bus.position_m);
    return {.joint = at, .position = at, .jacobian = Vector::Ones(1), .damping = &damping_, .latched = now};
  }
  void apply(Nanoseconds, const Vector& force_N) noexcept override { bus.force_N = force_N[0]; }
  std::optional<Nanoseconds> released_at() const noexcept override { return std::nullopt; }

  /// In place of hardware: the last values on the bus.
  struct Bus {
    bool powered = false;
    int readings = 0;
    double position_m = 0;
    double force_N = 1;
  } bus;

 private:
  forcebound::control::DeviceFacts facts_;
  forcebound::control::Damping damping_ = forcebound::control::Damping::from_matrix(Vector::Ones(1));
};
