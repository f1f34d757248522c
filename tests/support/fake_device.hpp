#pragma once

#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "forcebound/device/haptic_device.hpp"

namespace forcebound::test {

/// A Cartesian device whose position the test sets, and that records its commands.
class FakeDevice final : public device::HapticDevice {
 public:
  explicit FakeDevice(int degrees_of_freedom, double damping_N_s_per_m = 30)
      : damping_(control::Damping::from_matrix(damping_N_s_per_m *
                                               control::Matrix::Identity(degrees_of_freedom, degrees_of_freedom))) {
    facts_.name = "fake";
    facts_.damping = damping_.matrix();
    facts_.friction = facts_.encoder_step = facts_.actuator_step = control::Vector::Zero(degrees_of_freedom);
    facts_.force_N_max = 30;
    facts_.hold_s_max = 1;
    position = control::Vector::Zero(degrees_of_freedom);
  }

  [[nodiscard]] const control::DeviceFacts& facts() const noexcept override { return facts_; }
  /// None: forces are as a test asks for them.
  [[nodiscard]] device::Safety safety() const noexcept override { return {}; }

  device::Reading read(time::Nanoseconds now) noexcept override {
    const Eigen::Index dof = position.rows();
    return {.joint = position,
            .position = position,
            .jacobian = control::Matrix::Identity(dof, dof),
            .damping = &damping_,
            .latched = now - latched_before,
            .status = status,
            .handle = handle};
  }

  void apply(time::Nanoseconds now, const control::Vector& force_N) noexcept override {
    applied = force_N;
    applied_at = now;
  }

  [[nodiscard]] std::optional<time::Nanoseconds> released_at() const noexcept override { return released; }
  [[nodiscard]] std::optional<time::Nanoseconds> effective_at() const noexcept override { return effective; }
  [[nodiscard]] bool write_failed() const noexcept override { return write_lost; }
  [[nodiscard]] std::string_view last_error() const noexcept override { return "it is unplugged"; }

  /// As facts that are read at each tick; a law keeps those of before.
  void set_hold(double hold_s_max, bool releases) {
    facts_.hold_s_max = hold_s_max;
    facts_.releases = releases;
  }

  control::Vector position;
  control::Vector applied;
  time::Nanoseconds applied_at{0};
  std::optional<time::Nanoseconds> released;
  std::optional<time::Nanoseconds> effective;
  bool write_lost = false;
  time::Nanoseconds latched_before{0};  ///< how long before its reading
  device::Reading::Status status = device::Reading::Status::ok;
  control::Handle handle{};

 private:
  control::DeviceFacts facts_;
  control::Damping damping_;
};

}  // namespace forcebound::test
