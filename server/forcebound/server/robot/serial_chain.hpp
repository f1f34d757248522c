#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "forcebound/server/robot/robot_model.hpp"

namespace forcebound::server {

/// A link of a SerialChain, and the turning joint between it and the link before.
struct ChainLink {
  Eigen::Isometry3d from_before{Eigen::Isometry3d::Identity()};  ///< this link's frame in the one before, at q = 0
  Eigen::Vector3d axis{0, 0, 1};  ///< of the joint, through this link's origin; unit length, this link's frame
  double mass_kg = 0;
  Eigen::Vector3d centre{Eigen::Vector3d::Zero()};   ///< of the mass, this link's frame
  Eigen::Matrix3d inertia{Eigen::Matrix3d::Zero()};  ///< about that centre, axes of this link's frame [kg m^2]
  double rotor_kg_m2 = 0;                            ///< the motor's inertia, seen behind its gear
};

/// An arm of rigid links in a row. M is found by composite rigid bodies [Walker and Orin 1982], with the rotors'
/// inertia on its diagonal.
class SerialChain final : public RobotModel {
 public:
  struct Description {
    std::string name;
    std::vector<ChainLink>
        links;  ///< from the base on, 1 to control::kJointsMax; what is fixed to a link is part of it
    Eigen::Isometry3d tool{Eigen::Isometry3d::Identity()};  ///< in the last link's frame
    RobotLimits limits;
    Vector rest;
    std::vector<LinkShape> shapes;
  };

  /// @throws std::invalid_argument unless there are 1 to 7 links, and as many rows of limits and rest.
  explicit SerialChain(Description description);

  [[nodiscard]] std::string_view name() const noexcept override { return description_.name; }
  [[nodiscard]] int joints() const noexcept override { return static_cast<int>(description_.links.size()); }
  [[nodiscard]] ToolPose pose(const Vector& q) const noexcept override;
  [[nodiscard]] ToolJacobian jacobian(const Vector& q) const noexcept override;
  [[nodiscard]] Matrix mass_matrix(const Vector& q) const noexcept override;
  /// The torques that hold the links, and what is fixed to them, against gravity. Real time as the others.
  [[nodiscard]] Vector gravity(const Vector& q) const noexcept;
  [[nodiscard]] const RobotLimits& limits() const noexcept override { return description_.limits; }
  [[nodiscard]] const Vector& rest() const noexcept override { return description_.rest; }
  [[nodiscard]] const std::vector<LinkShape>& shapes() const noexcept override { return description_.shapes; }
  [[nodiscard]] LinkFrames link_frames(const Vector& q) const noexcept override;

 private:
  [[nodiscard]] const ChainLink& link(int number) const noexcept {
    return description_.links[static_cast<std::size_t>(number)];
  }

  Description description_;
};

}  // namespace forcebound::server
