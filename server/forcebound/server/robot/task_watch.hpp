#pragma once

#include <Eigen/Core>

#include "forcebound/server/robot/surroundings.hpp"
#include "forcebound/server/robot/task_world.hpp"

namespace forcebound::server {

/// Counts how far a task is done, from the simulation's truth.
///
/// Real time: `pass` is noexcept and allocates nothing.
class TaskWatch {
 public:
  /// What the step before ended with.
  struct Truth {
    double time_s = 0;  ///< since the start
    double step_s = 0;  ///< length of that step
    const BodyState& tool;
    const BodyState& block;
    const Vector6& wrench;  ///< of the tool on its surroundings
    bool touches = false;
  };

  explicit TaskWatch(const Task::World& world);

  void pass(const Truth& truth) noexcept;
  [[nodiscard]] const TaskProgress& progress() const noexcept { return progress_; }

 private:
  [[nodiscard]] double measured(const Truth& truth) noexcept;
  [[nodiscard]] double held_s(const Truth& truth) noexcept;
  [[nodiscard]] double slid_m(const Truth& truth) noexcept;
  [[nodiscard]] double inserted_m(const Truth& truth) const noexcept;

  TaskGoal goal_;
  Eigen::Vector3d block_start_{Eigen::Vector3d::Zero()};
  Eigen::Vector3d hole_{Eigen::Vector3d::Zero()};
  double hole_radius_m_ = 0;
  TaskProgress progress_;
  double held_s_ = 0;
  double apart_s_ = 0;  // since the tool left the object
  bool sliding_ = false;
  double slid_least_ = 0;  // of the tool's place along the direction, since it touched
  double slid_most_ = 0;
};

}  // namespace forcebound::server
