#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "forcebound/control/force_bounder.hpp"
#include "forcebound/device/command_times.hpp"
#include "forcebound/server/robot/impedance_controller.hpp"
#include "forcebound/server/robot/simulated_arm.hpp"
#include "forcebound/server/robot/task.hpp"

namespace forcebound::server {

/// A world with nothing but a surface far below, for a robot that touches nothing.
inline Task free_task() {
  return parse_task(R"(
summary = "nothing to touch"
degrees_of_freedom = 1
time_s = 1
tool = { kind = "fingertip", radius_m = 0.01 }
start = { position_m = [0.5, 0, 0.3] }
goal = { kind = "hold_force", time_s = 1, force_N_least = 1, force_N_most = 2 }
[[object]]
name = "floor"
shape = "surface"
position_m = [0, 0, -2]
stiffness_N_per_m = 10000
[[waypoint]]
time_s = 1
position_m = [0.5, 0, 0.3]
)",
                    "tests/free.toml");
}

inline ToolTarget held(const ToolPose& pose) { return {.pose = pose}; }

/// The script as a target for the robot that starts at this pose.
inline ToolTarget scripted(const Task& task, const ToolPose& start, double time_s) {
  const ScriptTarget target = task.target(time_s);
  ToolTarget tool{.pose = {.position = target.position, .orientation = start.orientation}};
  tool.velocity = target.velocity;
  return tool;
}

/// The arm, led by the controller along the task's script without any law.
inline TaskProgress follow_script(const Task& task, SimulatedArm& arm, ImpedanceController& controller) {
  const ToolPose start = arm.model().pose(arm.truth().joint);
  for (int tick = 0; tick <= static_cast<int>(1e3 * task.time_s); ++tick) {
    const Nanoseconds now = std::chrono::milliseconds(tick);
    const device::Reading reading = arm.read(now);
    arm.apply(now, controller.torque(reading, scripted(task, start, 1e-3 * tick)));
  }
  return arm.progress();
}

/// Torques through a law, as a robot's loop has it.
class LawfulTick {
 public:
  LawfulTick(SimulatedArm& arm, std::unique_ptr<control::PassivityLaw> law)
      : arm_(arm), times_(arm), bounder_(arm.facts(), std::move(law)) {}

  /// @return the reading, and what was applied
  Vector tick(Nanoseconds now, const device::Reading& reading, const Vector& torque) {
    times_.begin_choosing(now);
    const Vector chosen = bounder_.tick(times_.motion_at(reading), torque);
    const Vector applied = bounder_.confirmed(chosen, times_.command_at(reading, now));
    arm_.apply(now, applied);
    return applied;
  }

 private:
  SimulatedArm& arm_;
  device::CommandTimes times_;
  control::ForceBounder bounder_;
};

}  // namespace forcebound::server
