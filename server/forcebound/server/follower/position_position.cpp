#include "forcebound/server/follower/architecture.hpp"

namespace forcebound::server {
namespace {

/// Places go both ways: tool and device are tied by one spring and damper, whose force on the tool the hand feels as
/// its opposite [Hannaford 1989].
///
///     f = -K (x_wanted - x)
///
/// Needs no sensor; in free space the hand feels the robot's lag.
class PositionPosition final : public Architecture {
 public:
  explicit PositionPosition(const ImpedanceSettings& impedance) noexcept
      : stiffness_N_per_m_(impedance.stiffness_N_per_m), force_N_max_(impedance.force_N_max) {}

  [[nodiscard]] ToolTarget ask(const Seen& seen) noexcept override {
    tool_m_ = seen.tool.position;
    return seen.target;
  }

  [[nodiscard]] Reflection reflection() const noexcept override {
    return {.tie_N_per_m = stiffness_N_per_m_, .tool_m = tool_m_, .force_N_max = force_N_max_};
  }

 private:
  double stiffness_N_per_m_;
  double force_N_max_;
  Eigen::Vector3d tool_m_{Eigen::Vector3d::Zero()};
};

}  // namespace

ArchitectureKind position_position() {
  return {.name = "position-position",
          .summary = "one spring and damper between device and tool",
          .make = [](const ImpedanceSettings& impedance) { return std::make_unique<PositionPosition>(impedance); }};
}

}  // namespace forcebound::server
