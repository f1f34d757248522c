#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "forcebound/server/follower/follower.hpp"
#include "forcebound/server/robot/robot_model.hpp"
#include "forcebound/server/robot/task.hpp"
#include "forcebound/view/description.hpp"

namespace forcebound::server {

/// How a robot at work looks: links, gripper, what it holds, its surroundings, where the leader's device is among them,
/// and the numbers of a panel beside the picture. The picture's frame is the robot's world.
///
/// Two groups move: the solids, and the values of `value_names`. The solid `leader` is the frame of the leader's
/// device:
///
///     x_world = x_leader + m R p        m, R of WorkspaceSettings; m is the `scale` of that shape
class FollowerAppearance {
 public:
  static constexpr std::size_t kSolids = 0;  ///< groups of the description
  static constexpr std::size_t kValues = 1;

  /// @param model must outlive it
  /// @param task null: nothing is known of what the robot holds and of its surroundings
  FollowerAppearance(const RobotModel& model, const Task* task, const FollowerSettings& settings, bool is_audited);

  [[nodiscard]] const std::shared_ptr<const view::Description>& description() const noexcept { return description_; }

  /// As Environment::sample. Real time: noexcept, no allocation; the links' poses are found here, not on the robot's
  /// tick.
  [[nodiscard]] std::size_t sample(const FollowerReport& report, std::size_t group, std::size_t first,
                                   std::span<float> to) const noexcept;

  /// With their units; the last ones only of robots that are audited.
  [[nodiscard]] static std::vector<std::string> value_names(bool is_audited);

 private:
  /// What a solid moves with.
  struct Solid {
    enum class On : std::uint8_t { link, tool, block, leader };
    On on = On::link;
    int link = -1;  ///< -1: the base
    Eigen::Isometry3d place{Eigen::Isometry3d::Identity()};
    Eigen::Vector3d opens_m{Eigen::Vector3d::Zero()};
  };

  [[nodiscard]] std::size_t sample_solids(const FollowerReport& report, std::size_t first,
                                          std::span<float> to) const noexcept;
  [[nodiscard]] std::size_t sample_values(const FollowerReport& report, std::size_t first,
                                          std::span<float> to) const noexcept;

  const RobotModel& model_;
  std::vector<Solid> solids_;
  std::size_t values_ = 0;
  std::shared_ptr<const view::Description> description_;
};

}  // namespace forcebound::server
