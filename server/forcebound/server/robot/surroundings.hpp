#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "forcebound/server/robot/task_world.hpp"

namespace forcebound::server {

/// Where a rigid body is and how it moves; world frame.
struct BodyState {
  Eigen::Vector3d position{Eigen::Vector3d::Zero()};  ///< of its reference point
  Eigen::Matrix3d axes{Eigen::Matrix3d::Identity()};
  Eigen::Vector3d velocity{Eigen::Vector3d::Zero()};  ///< of that point
  Eigen::Vector3d turn{Eigen::Vector3d::Zero()};

  [[nodiscard]] Eigen::Vector3d velocity_at(const Eigen::Vector3d& point) const noexcept {
    return velocity + turn.cross(point - position);
  }
};

/// The world of a task: where the tool and the block touch things, and what that exerts on them.
///
/// Only the tool and the block touch anything; the robot's links pass through. A plug touches a hole with points of its
/// edge and chamfer, and with its side at points of the hole's edge. Forces are those of PointContact, for the
/// positions and velocities at the beginning of a step.
///
/// Real time: `touch` is noexcept and allocates nothing.
class Surroundings {
 public:
  /// Force [N] above torque about the body's reference point [N m], world frame.
  struct Forces {
    Vector6 tool{Vector6::Zero()};
    Vector6 block{Vector6::Zero()};
    bool tool_touches = false;
  };

  explicit Surroundings(const Task::World& world);

  /// The forces on tool and block for a step of this length. Once for each step.
  [[nodiscard]] Forces touch(const BodyState& tool, const BodyState& block, double step_s) noexcept;

  /// How far the block's centre sinks below its height on the surface under its own weight [m].
  [[nodiscard]] static double sunk_m(const WorldObject& block, const WorldObject& surface) noexcept;

 private:
  static constexpr int kRing = 12;
  static constexpr int kPoints = 3 * kRing;  // of one object
  struct Place {
    WorldObject object;
    std::array<PointContact, kPoints> tool{};
    std::array<PointContact, 8> corners{};
  };
  struct Call;

  void touch_surface(Place& place, Call& call) const noexcept;
  void touch_box(Place& place, Call& call) const noexcept;
  void touch_hole(Place& place, Call& call) const noexcept;

  ToolShape tool_;
  std::vector<Place> places_;
  Eigen::Vector3d block_half_{Eigen::Vector3d::Zero()};  // zero: there is no block
};

}  // namespace forcebound::server
