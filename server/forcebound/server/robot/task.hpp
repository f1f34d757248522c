#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/server/robot/robot.hpp"

namespace forcebound::server {

/// A point of the operator's script: where the tool shall be at a time. Between two, it moves in a straight line, at
/// rest at both ends (minimum jerk).
struct ToolWaypoint {
  double time_s = 0;                                  ///< since the work began
  Eigen::Vector3d position{Eigen::Vector3d::Zero()};  ///< of the tool's point, world frame [m]
  Eigen::Vector3d rotation{Eigen::Vector3d::Zero()};  ///< from the tool's orientation at the start, world frame [rad]
  double grip = 0;                                    ///< the gripper's opening, 0 to 1
};

/// A search in the horizontal plane, added to the script: circles whose radius grows evenly, and shrinks to nothing in
/// the half second after.
struct ToolSpiral {
  double begin_s = 0;
  double end_s = 0;  ///< not after `begin_s`: there is none
  double turns = 0;
  double radius_m = 0;
};

/// The script's target at a time: its first waypoint before that, its last one after, and the search.
struct ScriptTarget {
  Eigen::Vector3d position{Eigen::Vector3d::Zero()};
  Eigen::Vector3d velocity{Eigen::Vector3d::Zero()};
  Eigen::Vector3d rotation{Eigen::Vector3d::Zero()};
  double grip = 0;
};

/// What the simulation knows of the work: the truth, which no law and no controller may see.
struct TaskProgress {
  Eigen::Vector3d force_N{Eigen::Vector3d::Zero()};     ///< of the tool on its surroundings, world frame
  Eigen::Vector3d torque_N_m{Eigen::Vector3d::Zero()};  ///< likewise, about the tool's point
  ToolPose tool{};
  Vector6 tool_velocity{Vector6::Zero()};
  bool in_contact = false;
  double measure = 0;      ///< what the task counts: see Task::measure
  double goal = 0;         ///< that of it which is needed
  bool succeeded = false;  ///< the goal was reached, once and for all
  double succeeded_s = 0;  ///< when, since the robot's start; 0: not yet
  double peak_N = 0;       ///< largest contact force so far
};

/// Work for a robot, and for the person who leads it.
struct Task {
  std::string name;
  std::string summary;              ///< in a line
  std::string measure;              ///< what is counted, with its unit: "depth of the plug [m]"
  int degrees_of_freedom = 3;       ///< that a leader needs at least
  double time_s = 8;                ///< the script's length
  double stiffness_N_per_m = 0;     ///< of a point that touches the first object, along the normal: the truth
  double friction = 0;              ///< likewise, its coefficient
  Eigen::Vector3d normal{0, 0, 1};  ///< of the surface that is worked on, out of it, world frame
  std::vector<ToolWaypoint> script;
  ToolSpiral spiral;
  struct World;
  std::shared_ptr<const World> world;  ///< bodies, start and goal

  [[nodiscard]] ScriptTarget target(double time_s) const noexcept;
};

/// A robot in the world of its task.
class TaskRobot : public Robot {
 public:
  /// At the latest reading or command.
  [[nodiscard]] virtual TaskProgress progress() const noexcept = 0;
};

/// @param text of a task's file, named by `file` in errors. @throws config::ConfigError
[[nodiscard]] Task parse_task(std::string_view text, const std::string& file);

/// @param name_or_file of a task that ships, or FILE.toml
/// @throws std::invalid_argument for a name that does not exist, with the nearest one that does
/// @throws config::ConfigError, with file, line and accepted values
[[nodiscard]] Task load_task(const std::string& name_or_file);

/// The names of the tasks that ship.
[[nodiscard]] std::vector<std::string> task_names();

/// Whether there are simulated robots: they need MuJoCo.
[[nodiscard]] bool has_simulated_robots() noexcept;

/// The simulated arm at the task's start. @param seed of the sensor's noise and bias.
/// @throws std::runtime_error naming the pose, if the arm cannot reach it; or if Forcebound was built without MuJoCo
[[nodiscard]] std::unique_ptr<TaskRobot> make_robot(const Task& task, std::uint64_t seed);

}  // namespace forcebound::server
