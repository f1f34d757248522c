#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/device/device_description.hpp"
#include "forcebound/server/follower/follower.hpp"
#include "forcebound/server/robot/task.hpp"
#include "tests/tools/lab/teleoperation/robot_flaws.hpp"
#include "tests/tools/lab/teleoperation/script_operator.hpp"
#include "tests/tools/lab/trials/task.hpp"
#include "tests/tools/sim/closed_loop.hpp"

namespace forcebound::lab {

/// One task done from afar: a hand with its device, a network, and a robot at work, in virtual time.
struct TeleoperationSetup {
  server::Task task;
  device::DeviceDescription device;
  device::Hand hand{};            ///< no mass, no stiffness: that of ScriptOperator
  std::string law = "fba-exact";  ///< at both ends
  server::FollowerSettings follower{};
  NamedNetwork network{};
  std::uint64_t seed = 1;
  std::function<std::unique_ptr<const device::Operator>()> make_hand{};  ///< replaces the script's, if set
  std::vector<sim::ClosedLoop::Fault> faults{};
  RobotFlaws flaws{};
  double force_slew_N_per_s = 2000;  ///< of the client: a surface that is found late does not strike
  double duration_s = 0;             ///< 0: the operator's script and a second more
};

/// What it came to.
struct TeleoperationMeasures {
  double leader_minimum_J = 0;       ///< least P of the hand's side, of the device's own audit
  double leader_kept_minimum_J = 0;  ///< least of P less what the law there gave up: what was given was there
  double follower_minimum_J = 0;     ///< least P_F of the robot's side, received energy included
  double given_J = 0;                ///< by the leader's law
  double received_J = 0;             ///< by the robot, at its scale
  double tracking_rms_m = 0;     ///< where the leader is, in the robot's world, to where the tool is, while it follows
  double force_error_rms_N = 0;  ///< shown at the hand, less the true contact force at its scale; in contact
  double stiffness_ratio = 0;    ///< displayed over true, at its scale; not a number: no contact that tells
  double peak_N = 0;             ///< largest contact force
  bool succeeded = false;
  double completed_s = 0;  ///< since the work began; not a number: it did not succeed
  double measure = 0;      ///< the task's own
  double goal = 0;
  std::uint64_t stops = 0;
  std::string why_stopped;
  double bounded_share = 0;  ///< of the robot's ticks, on which its law shortened the torques
  double lag_m_max = 0;
  double lurch_m_per_s = 0;  ///< LurchMeter
};

/// What both ends do on one millisecond, for figures and tables of faults.
struct TeleoperationMoment {
  double time_s = 0;
  control::FollowerState state = control::FollowerState::none;
  Eigen::Vector3d leader_m{Eigen::Vector3d::Zero()};  ///< in the robot's world
  Eigen::Vector3d tool_m{Eigen::Vector3d::Zero()};
  double tool_speed_m_per_s = 0;
  double shown_N = 0;    ///< size of the force on the hand
  double contact_N = 0;  ///< size of the true contact force
  Eigen::Vector3d shown_in_world_N{Eigen::Vector3d::Zero()};
  double shown_along_N = 0;  ///< the force on the hand along the task's normal, robot's world
};

/// @param moments may be null
[[nodiscard]] TeleoperationMeasures run_teleoperation(const TeleoperationSetup& setup,
                                                      std::vector<TeleoperationMoment>* moments = nullptr);

}  // namespace forcebound::lab
