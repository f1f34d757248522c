#pragma once

#include <memory>
#include <string>

#include "forcebound/device/simulated/operator.hpp"

namespace forcebound::client::commands {

/// Nobody: a simulated device that no hand touches.
class Nobody final : public device::Operator {
 public:
  explicit Nobody(int degrees_of_freedom) : degrees_of_freedom_(degrees_of_freedom) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "nobody"; }
  [[nodiscard]] const device::Hand& hand() const noexcept override { return hand_; }
  [[nodiscard]] int degrees_of_freedom() const noexcept override { return degrees_of_freedom_; }
  [[nodiscard]] Target target(double /*time_s*/) const noexcept override {
    const control::Vector zero = control::Vector::Zero(degrees_of_freedom_);
    return {.position = zero, .velocity = zero, .grip = 0};
  }
  [[nodiscard]] std::string description() const override { return "nobody touches it"; }

 private:
  int degrees_of_freedom_;
  device::Hand hand_{};
};

}  // namespace forcebound::client::commands
