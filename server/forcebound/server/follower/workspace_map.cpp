#include "forcebound/server/follower/workspace_map.hpp"

#include <stdexcept>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/control/translation.hpp"

namespace forcebound::server {
namespace {

std::optional<Eigen::Quaterniond> orientation_of(const control::Handle& handle) noexcept {
  if (!handle.orientation) return std::nullopt;
  const auto& [w, x, y, z] = *handle.orientation;
  return Eigen::Quaterniond(w, x, y, z).normalized();
}

void check(const char* what, double value, double least, double most) {
  if (value >= least && value <= most) return;
  control::ClassicText text;
  text << what << " must be " << least << " to " << most << ", got " << value;
  throw std::invalid_argument(text.str());
}

}  // namespace

WorkspaceMap::WorkspaceMap(const WorkspaceSettings& settings) : settings_(settings) {
  check("motion scale", settings.motion_scale, 0.01, 100);
  check("force scale", settings.force_scale, 0.001, 100);
  constexpr double kRounding = 1e-9;
  const Eigen::Matrix3d& r = settings.rotation;
  if (!r.allFinite() || !(r * r.transpose()).isIdentity(kRounding) || r.determinant() < 0) {
    throw std::invalid_argument("rotation of the workspace must be a rotation matrix of three rows");
  }
}

void WorkspaceMap::engage(const LeaderMotion& leader, const ToolPose& tool) noexcept {
  leader_start_m_ = control::translation_of(leader.position);
  leader_orientation_ = orientation_of(leader.handle);
  tool_start_ = tool;
}

ToolPose WorkspaceMap::tool_of(const LeaderMotion& leader) const noexcept {
  ToolPose tool = tool_start_;
  tool.position +=
      settings_.motion_scale * (settings_.rotation * (control::translation_of(leader.position) - leader_start_m_));
  const auto orientation = orientation_of(leader.handle);
  if (orientation && leader_orientation_) {
    const Eigen::Quaterniond turned = *orientation * leader_orientation_->conjugate();
    const Eigen::Quaterniond axes(settings_.rotation);
    tool.orientation = (axes * turned * axes.conjugate() * tool_start_.orientation).normalized();
  }
  return tool;
}

Eigen::Isometry3d WorkspaceMap::leader_frame() const noexcept {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  frame.linear() = settings_.rotation;
  frame.translation() = tool_start_.position - settings_.motion_scale * (settings_.rotation * leader_start_m_);
  return frame;
}

local_model::Point WorkspaceMap::leader_place_m(const Eigen::Vector3d& tool_point_m) const noexcept {
  return leader_start_m_ +
         settings_.rotation.transpose() * (tool_point_m - tool_start_.position) / settings_.motion_scale;
}

}  // namespace forcebound::server
