#pragma once

#include <cstdint>
#include <string>

#include "forcebound/device/simulated/operator.hpp"
#include "forcebound/server/follower/workspace_map.hpp"
#include "forcebound/server/robot/task.hpp"

namespace forcebound::lab {

/// A hand that works by a task's script, as one who sees the robot would: at rest for a second, then along the
/// waypoints, in the leader's frame. What differs from person to person is drawn from a seed: how fast (by a tenth),
/// how far aside (half a millimetre), and a tremor of 0.1 mm at 8 to 10 Hz.
class ScriptOperator final : public device::Operator {
 public:
  static constexpr double kRest_s = 1;

  struct Settings {
    server::WorkspaceSettings workspace{};
    int degrees_of_freedom = 3;
    std::uint64_t seed = 1;
    device::Hand hand{.mass_kg = 0.2, .stiffness_N_per_m = 2000, .damping_N_s_per_m = 25};
  };

  ScriptOperator(server::Task task, const Settings& settings);

  [[nodiscard]] std::string_view name() const noexcept override { return "script"; }
  [[nodiscard]] const device::Hand& hand() const noexcept override { return settings_.hand; }
  [[nodiscard]] int degrees_of_freedom() const noexcept override { return settings_.degrees_of_freedom; }
  [[nodiscard]] Target target(double time_s) const noexcept override;
  [[nodiscard]] control::Handle handle(double time_s) const noexcept override;
  [[nodiscard]] std::string description() const override;

  /// Until it has gone through the script.
  [[nodiscard]] double duration_s() const noexcept { return kRest_s + task_.time_s / pace_; }
  [[nodiscard]] double pace() const noexcept { return pace_; }

 private:
  [[nodiscard]] double script_s(double time_s) const noexcept { return pace_ * (time_s - kRest_s); }

  server::Task task_;
  Settings settings_;
  double pace_ = 1;
  Eigen::Vector3d aside_m_{Eigen::Vector3d::Zero()};  // once it works
  Eigen::Vector3d tremor_rad_per_s_{Eigen::Vector3d::Zero()};
  Eigen::Vector3d tremor_phase_{Eigen::Vector3d::Zero()};
};

}  // namespace forcebound::lab
