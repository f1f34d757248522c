#include "forcebound/server/follower/architecture.hpp"

namespace forcebound::server {
namespace {

/// Places go both ways: tool and device are tied by one spring and damper, whose force on the tool the hand feels as
/// its opposite [Hannaford 1989].
///
///     f = -K (x_wanted - x),   torque = K_r rotation vector from the wanted orientation to the tool's
///
/// Needs no sensor; in free space the hand feels the robot's lag.
class PositionPosition final : public Architecture {
 public:
  explicit PositionPosition(const ImpedanceSettings& impedance) noexcept : impedance_(impedance) {}

  [[nodiscard]] ToolTarget ask(const Sample& sample) noexcept override {
    tool_ = sample.tool;
    return sample.target;
  }

  [[nodiscard]] Reflection reflection() const noexcept override {
    return {.tie_N_per_m = impedance_.stiffness_N_per_m,
            .tool_m = tool_.position,
            .force_N_max = impedance_.force_N_max,
            .turn_N_m_per_rad = impedance_.stiffness_N_m_per_rad,
            .tool_orientation = tool_.orientation,
            .torque_N_m_max = largest_torque_N_m(impedance_)};
  }

 private:
  ImpedanceSettings impedance_;
  ToolPose tool_{};
};

}  // namespace

ArchitectureKind position_position() {
  return {.name = "position-position",
          .summary = "one spring and damper between device and tool",
          .make = [](const ImpedanceSettings& impedance) { return std::make_unique<PositionPosition>(impedance); }};
}

}  // namespace forcebound::server
