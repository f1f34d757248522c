#include "forcebound/server/follower/architecture.hpp"

namespace forcebound::server {
namespace {

/// The robot follows the place, the hand feels what the sensor at the wrist measures [Lawrence 1993: two of the four
/// channels].
///
///     f = -f_sensed,   torque = -torque sensed about the tool's point
///
/// In free space the hand feels nothing of the robot.
class PositionForce final : public Architecture {
 public:
  explicit PositionForce(const ImpedanceSettings& impedance) noexcept
      : force_N_max_(impedance.force_N_max), torque_N_m_max_(largest_torque_N_m(impedance)) {}

  [[nodiscard]] ToolTarget ask(const Sample& sample) noexcept override {
    sensed_ = sample.sensed.value_or(Vector6::Zero());
    return sample.target;
  }
  [[nodiscard]] Reflection reflection() const noexcept override {
    return {.force_N = -sensed_.head<3>(),
            .force_N_max = force_N_max_,
            .torque_N_m = -sensed_.tail<3>(),
            .torque_N_m_max = torque_N_m_max_};
  }

 private:
  double force_N_max_;
  double torque_N_m_max_;
  Vector6 sensed_{Vector6::Zero()};
};

ArchitectureKind kind(std::string_view name, std::string_view summary, const ImpedanceSettings& impedance) {
  return {.name = name,
          .summary = summary,
          .needs_sensor = true,
          .impedance = impedance,
          .make = [](const ImpedanceSettings& chosen) { return std::make_unique<PositionForce>(chosen); }};
}

}  // namespace

ArchitectureKind position_force() {
  return kind("position-force", "the tool follows the device, the hand feels the wrist's sensor", {});
}

ArchitectureKind position_force_damped() {
  // Damping at the robot takes the energy of impacts before it is reflected.
  constexpr double kDampingRatio = 2.5;
  return kind("position-force-damped", "the same with local damping: the tool is overdamped, impacts are softer",
              {.damping_ratio = kDampingRatio});
}

}  // namespace forcebound::server
