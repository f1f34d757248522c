#include "forcebound/server/follower/architecture.hpp"

#include <algorithm>
#include <numbers>
#include <stdexcept>

#include "forcebound/control/rotation.hpp"
#include "forcebound/local_model/no_longer_than.hpp"

namespace forcebound::server {

Eigen::Vector3d Reflection::at(const Eigen::Vector3d& wanted_m) const noexcept {
  const auto cut = [this](const Eigen::Vector3d& part) { return local_model::no_longer_than(part, force_N_max); };
  Eigen::Vector3d sum = cut(force_N) + cut(tie_N_per_m * (tool_m - wanted_m));
  Eigen::Vector3d lag_m = tool_m - wanted_m;
  if (plane) {
    const double depth_m = std::max(0.0, (plane->place_m - wanted_m).dot(plane->normal));
    sum += std::min(plane->stiffness_N_per_m * depth_m, force_N_max) * plane->normal;
    lag_m -= depth_m * plane->normal;  // within the plane the tool is not to follow
  }
  const double size_m = lag_m.norm();
  if (size_m > tow_slack_m) sum += cut(tow_N_per_m * (1 - tow_slack_m / size_m) * lag_m);
  return sum;
}

Eigen::Vector3d Reflection::torque_at(const Eigen::Quaterniond& wanted) const noexcept {
  const Eigen::Vector3d lag_rad = control::rotation_vector(wanted, tool_orientation);
  constexpr double kFades_rad = 2;
  const auto cut = [this](const Eigen::Vector3d& part) { return local_model::no_longer_than(part, torque_N_m_max); };
  const double left = (std::numbers::pi - lag_rad.norm()) / (std::numbers::pi - kFades_rad);
  return cut(torque_N_m) + std::clamp(left, 0.0, 1.0) * cut(turn_N_m_per_rad * lag_rad);
}

const std::vector<ArchitectureKind>& architectures() {
  static const std::vector<ArchitectureKind> kAll{position_position(), position_force(), position_force_damped(),
                                                  model_mediated()};
  return kAll;
}

const ArchitectureKind& find_architecture(std::string_view name) {
  const auto& all = architectures();
  const auto found = std::ranges::find(all, name, &ArchitectureKind::name);
  if (found != all.end()) return *found;
  std::string known;
  for (const ArchitectureKind& kind : all) known += (known.empty() ? "" : ", ") + std::string(kind.name);
  throw std::invalid_argument("no architecture '" + std::string(name) + "' (known: " + known + ")");
}

}  // namespace forcebound::server
