#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "forcebound/server/robot/point_contact.hpp"
#include "forcebound/server/robot/task.hpp"

namespace forcebound::server {

/// What the robot holds, fixed in its gripper. Its point is the tool's point, its axis the tool's z axis, outward.
struct ToolShape {
  enum class Kind : std::uint8_t {
    fingertip,  ///< a sphere about the tool's point
    plug,       ///< a cylinder that ends at the tool's point, with a chamfered edge
  };
  Kind kind = Kind::fingertip;
  double radius_m = 0.01;
  double length_m = 0.04;   ///< of a plug
  double chamfer_m = 5e-4;  ///< likewise
};

/// Something in the world that the tool, or the block, touches. World frame.
struct WorldObject {
  enum class Shape : std::uint8_t {
    surface,  ///< everything below the plane through `position` with `normal`
    box,      ///< with half the size `half_size`, its sides along the world's axes, fixed
    hole,     ///< everything below that plane, but for a round hole of `radius` and `depth` along the normal, z
    block,    ///< a box that can be moved; at most one
  };
  std::string name;
  Shape shape = Shape::surface;
  Eigen::Vector3d position{Eigen::Vector3d::Zero()};
  Eigen::Vector3d normal{0, 0, 1};  ///< of a box or block: out of it where it shall be touched, for Task::normal alone
  Eigen::Vector3d half_size{Eigen::Vector3d::Zero()};
  double radius_m = 0;
  double depth_m = 0;
  double mass_kg = 0;
  ContactMaterial material;
};

/// When a task is done.
struct TaskGoal {
  enum class Kind : std::uint8_t {
    hold_force,  ///< the contact force stayed within a band, in one go [s]
    slide,       ///< the tool slid along a direction without leaving the object for more than 0.1 s [m]
    insert,      ///< the plug's end is below the surface, in the hole [m]
    push,        ///< the block was moved along a direction [m]
  };
  Kind kind = Kind::hold_force;
  double least = 0;  ///< of the measure
  double force_N_least = 0;
  double force_N_most = 0;
  Eigen::Vector3d direction{1, 0, 0};  ///< unit length
};

struct Task::World {
  ToolShape tool;
  std::vector<WorldObject> objects;
  ToolPose start;
  TaskGoal goal;

  /// Null: there is none.
  [[nodiscard]] const WorldObject* find(WorldObject::Shape shape) const noexcept {
    for (const WorldObject& object : objects) {
      if (object.shape == shape) return &object;
    }
    return nullptr;
  }
};

}  // namespace forcebound::server
