#include "forcebound/server/robot/serial_chain.hpp"

#include <stdexcept>
#include <utility>

namespace forcebound::server {
namespace {

/// Several links that move as one, in the world frame.
struct Composite {
  double mass_kg = 0;
  Eigen::Vector3d centre{Eigen::Vector3d::Zero()};
  Eigen::Matrix3d inertia{Eigen::Matrix3d::Zero()};  // about the centre

  void add(double more_kg, const Eigen::Vector3d& where, const Eigen::Matrix3d& own) noexcept {
    const double total_kg = mass_kg + more_kg;
    inertia += own;
    if (!(total_kg > 0)) return;
    const Eigen::Vector3d apart = where - centre;
    const double reduced_kg = mass_kg * more_kg / total_kg;
    inertia += reduced_kg * (apart.squaredNorm() * Eigen::Matrix3d::Identity() - apart * apart.transpose());
    centre += more_kg / total_kg * apart;
    mass_kg = total_kg;
  }
};

}  // namespace

SerialChain::SerialChain(Description description) : description_(std::move(description)) {
  const auto links = static_cast<Eigen::Index>(description_.links.size());
  if (links < 1 || links > control::kJointsMax) {
    throw std::invalid_argument("arm '" + description_.name + "' must have 1 to " +
                                std::to_string(control::kJointsMax) + " joints, got " + std::to_string(links));
  }
  const RobotLimits& limits = description_.limits;
  for (const Eigen::Index rows : {limits.lowest.rows(), limits.highest.rows(), limits.speed_max.rows(),
                                  limits.torque_max.rows(), description_.rest.rows()}) {
    if (rows == links) continue;
    throw std::invalid_argument("arm '" + description_.name + "' must have limits and a rest posture of " +
                                std::to_string(links) + " rows, got " + std::to_string(rows));
  }
}

LinkFrames SerialChain::link_frames(const Vector& q) const noexcept {
  LinkFrames frames;
  Eigen::Isometry3d before = Eigen::Isometry3d::Identity();
  for (int i = 0; i < joints(); ++i) {
    Eigen::Isometry3d& here = frames[static_cast<std::size_t>(i)];
    here = before * link(i).from_before;
    here.linear() = here.linear() * Eigen::AngleAxisd(q[i], link(i).axis).toRotationMatrix();
    before = here;
  }
  return frames;
}

ToolPose SerialChain::pose(const Vector& q) const noexcept {
  const LinkFrames all = link_frames(q);
  const Eigen::Isometry3d tool = all[static_cast<std::size_t>(joints() - 1)] * description_.tool;
  return {.position = tool.translation(), .orientation = Eigen::Quaterniond(tool.linear()).normalized()};
}

ToolJacobian SerialChain::jacobian(const Vector& q) const noexcept {
  const LinkFrames all = link_frames(q);
  const Eigen::Vector3d tool = all[static_cast<std::size_t>(joints() - 1)] * description_.tool.translation();
  ToolJacobian jacobian(6, joints());
  for (int i = 0; i < joints(); ++i) {
    const Eigen::Isometry3d& frame = all[static_cast<std::size_t>(i)];
    const Eigen::Vector3d axis = frame.linear() * link(i).axis;
    jacobian.col(i) << axis.cross(tool - frame.translation()), axis;
  }
  return jacobian;
}

Matrix SerialChain::mass_matrix(const Vector& q) const noexcept {
  const LinkFrames all = link_frames(q);
  Matrix mass(joints(), joints());
  Composite outward;
  for (int i = joints() - 1; i >= 0; --i) {
    const Eigen::Isometry3d& frame = all[static_cast<std::size_t>(i)];
    const Eigen::Matrix3d turn = frame.linear();
    outward.add(link(i).mass_kg, frame * link(i).centre, turn * link(i).inertia * turn.transpose());
    // Momentum of all links from here outward, of a unit speed of this joint alone.
    const Eigen::Vector3d axis = turn * link(i).axis;
    const Eigen::Vector3d linear = outward.mass_kg * axis.cross(outward.centre - frame.translation());
    const Eigen::Vector3d angular = outward.inertia * axis;
    for (int j = i; j >= 0; --j) {
      const Eigen::Isometry3d& inner = all[static_cast<std::size_t>(j)];
      const Eigen::Vector3d inner_axis = inner.linear() * link(j).axis;
      mass(i, j) = inner_axis.dot(angular + (outward.centre - inner.translation()).cross(linear));
      mass(j, i) = mass(i, j);
    }
    mass(i, i) += link(i).rotor_kg_m2;
  }
  return mass;
}

Vector SerialChain::gravity(const Vector& q) const noexcept {
  const LinkFrames all = link_frames(q);
  Vector torque(joints());
  double mass_kg = 0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // mass times centre, of all links from here outward
  for (int i = joints() - 1; i >= 0; --i) {
    const Eigen::Isometry3d& frame = all[static_cast<std::size_t>(i)];
    mass_kg += link(i).mass_kg;
    moment += link(i).mass_kg * (frame * link(i).centre);
    const Eigen::Vector3d axis = frame.linear() * link(i).axis;
    torque[i] = kGravity_m_per_s2 * axis.cross(moment - mass_kg * frame.translation()).z();
  }
  return torque;
}

}  // namespace forcebound::server
