#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "forcebound/control/force_bounder.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/command_times.hpp"
#include "forcebound/server/follower/architecture.hpp"
#include "forcebound/server/follower/engagement.hpp"
#include "forcebound/server/follower/grip.hpp"
#include "forcebound/server/follower/leader_motion.hpp"
#include "forcebound/server/follower/received_energy.hpp"
#include "forcebound/server/follower/sensor_bias.hpp"
#include "forcebound/server/follower/target_limiter.hpp"
#include "forcebound/server/follower/unanswered_torque.hpp"
#include "forcebound/server/follower/workspace_map.hpp"

namespace forcebound::server {

struct FollowerSettings {
  std::string architecture = "position-force";
  std::string law = "fba-exact";
  WorkspaceSettings workspace{};
  EngagementTimes times{};
  double store_J = 2;  ///< energy that the robot's law keeps at most; > 0
  /// E_0, energy that the robot's law begins with, 0 to `largest_initial_J`; none: the architecture's share of that.
  std::optional<double> initial_J{};
  double approach_m_per_s_max = 0.25;  ///< of the tool's target, > 0
  double turn_rad_per_s_max = 1;       ///< likewise
  double contact_N_max = 80;           ///< above this, sensed, the robot stops; > 0
  int clutch_button = 0;
  int grip_button = 1;  ///< closes the gripper, of a device without one
};

/// What a robot tells of itself for pictures and panels.
struct FollowerPicture {
  Vector joint{};      ///< of the newest reading that could be used; no rows: there was none
  double opening = 0;  ///< of the gripper, 0 to 1
  ToolPose tool{};     ///< by that reading
  std::optional<ToolPose> block{};
  Eigen::Vector3d sensed_N{Eigen::Vector3d::Zero()};    ///< of the tool on its surroundings, less the bias; world frame
  Eigen::Vector3d sensed_N_m{Eigen::Vector3d::Zero()};  ///< likewise, about the tool's point
  std::optional<bool> leader_has_clutch{};              ///< its handle has buttons; none: nobody leads
  double lag_m = 0;                                     ///< from the tool to its target
  double drift_m = 0;                                   ///< FollowerTotals::offset_drift_m
  double store_J = 0;                                   ///< energy that the robot's law may spend
  double received_J = 0;
  control::PassivityAudit port{};         ///< P_F + E_0 and its least; only of robots that are audited
  bool grip_waits = false;                ///< until the operator's grip has met where the gripper stands
  std::optional<Nanoseconds> bias_age{};  ///< since the sensor's bias was learned
};

/// What a robot tells of itself on each tick, for answers to its leader.
struct FollowerReport {
  FollowerState state = FollowerState::waiting;
  double share = 0;  ///< of the reflection that is shown: it begins and ends by degrees
  Reflection reflection{};
  WorkspaceMap map{{}};
  bool leader_lost = false;  ///< it was heard, and has been silent for so long that the robot stops
  SensorBias::Status bias{};
  FollowerPicture picture{};
};

/// Counts and measures since the start, for logs and studies.
struct FollowerTotals {
  std::uint64_t ticks = 0;
  std::uint64_t bounded = 0;  ///< ticks on which the law shortened the torques
  std::uint64_t stops = 0;
  control::ReadingCounts readings{};  ///< by status; those that the robot held its torques on for aside
  std::uint64_t motions_refused = 0;  ///< of the leader, farther away than any hand
  std::string_view why_stopped{};     ///< last
  double received_J = 0;              ///< energy of the leader's law, at the robot's scale
  double initial_J = 0;               ///< E_0
  control::PassivityAudit port{};     ///< P_F + E_0 and its least; only of simulated robots
  bool audited = false;
  double lag_m = 0;  ///< from tool to target, now
  double lag_m_max = 0;
  double offset_drift_m = 0;  ///< by which the leader moved while it was not followed, clutch aside
};

/// A robot that follows a device: the loop at the far end, at the robot's own rate.
///
///     leader's place -> map, scale, limits -> architecture -> impedance -> law -> joint torques -> robot
///     force, plane   <- map, scale         <- architecture <- sensor, encoders, estimator      <-
///
/// The law is that of the device at the hand, in the robot's joints: the torques can never give the surroundings more
/// energy than the robot's own joints dissipate, the leader's law gave up and the robot began with (ReceivedEnergy;
/// README.md has the proof).
///
/// `receive`, `leave`, `learn_bias` and `tick` are called on one thread. Time is given: the clock is asked only for how
/// long choosing takes.
///
/// Real time: `receive`, `leave` and `tick` are noexcept and allocate nothing.
class Follower {
 public:
  /// @throws std::invalid_argument naming the setting, its value and what is accepted; also where the architecture
  /// needs a sensor that the robot has not
  Follower(std::unique_ptr<Robot> robot, const FollowerSettings& settings, const control::LawRegistry& laws,
           const time::Clock& clock);

  /// @throws what the robot's start throws
  void start() { robot_->start(); }

  /// Another leader takes the robot.
  void begin_leader() noexcept;
  void receive(const LeaderMotion& motion) noexcept;
  void leave() noexcept { leader_.reset(); }

  /// Learn the bias of its force sensor now; the report's `bias` answers.
  void learn_bias(Nanoseconds now) noexcept { bias_.command(now); }

  void tick(Nanoseconds now) noexcept;

  /// Brings the robot to rest at once, and ends.
  void stop(Nanoseconds now) noexcept { robot_->soft_stop(now); }

  [[nodiscard]] const FollowerReport& report() const noexcept { return report_; }
  [[nodiscard]] FollowerTotals totals() const noexcept;
  [[nodiscard]] const Robot& robot() const noexcept { return *robot_; }
  [[nodiscard]] Robot& robot() noexcept { return *robot_; }
  [[nodiscard]] const control::PassivityLaw& law() const noexcept { return bounder_.law(); }
  [[nodiscard]] Nanoseconds period() const noexcept { return period_; }
  /// Why its latest reading or command failed: what the robot says, else why the reading was refused.
  [[nodiscard]] std::string_view last_error() const noexcept;
  [[nodiscard]] const FollowerSettings& settings() const noexcept { return settings_; }

 private:
  [[nodiscard]] bool judge(const device::Reading& reading, Nanoseconds now) noexcept;
  [[nodiscard]] std::string_view exceeded_limit(const device::Reading& reading, bool usable) const noexcept;
  [[nodiscard]] bool is_ready(bool usable, bool sensed) noexcept;
  void begin_following(const device::Reading& reading) noexcept;
  [[nodiscard]] bool brakes_open(const device::Reading& reading, bool usable, Nanoseconds now) noexcept;
  [[nodiscard]] Vector torque(const device::Reading& reading, Nanoseconds now) noexcept;
  void picture(const device::Reading& reading, Nanoseconds now) noexcept;
  [[nodiscard]] std::optional<Nanoseconds> bias_age(Nanoseconds now) const noexcept;
  [[nodiscard]] Vector within_rate(const Vector& torque) const noexcept;
  void grip(Nanoseconds now) noexcept;
  void update_bias(Nanoseconds now) noexcept;
  void update_report(const Vector& request, const Vector& given, Nanoseconds now) noexcept;

  FollowerSettings settings_;
  std::unique_ptr<Robot> robot_;
  const time::Clock& clock_;
  Nanoseconds period_;
  bool needs_sensor_;
  ImpedanceController impedance_;
  std::unique_ptr<Architecture> architecture_;
  control::ForceBounder bounder_;
  device::CommandTimes times_;
  Engagement engagement_;
  WorkspaceMap map_;
  TargetLimiter target_;
  ReceivedEnergy energy_;
  SensorBias bias_;
  Grip grip_;
  UnansweredTorque unanswered_;

  std::optional<LeaderMotion> leader_;
  double leader_speed_m_per_s_ = 0;
  bool leader_is_new_ = false;
  bool placed_ = false;  // the target is where the tool was first seen
  int lost_in_a_row_ = 0;
  device::Reading::Status lost_ = device::Reading::Status::ok;  // why the latest was
  int refused_in_a_row_ = 0;                                    // commands
  int unsensed_in_a_row_ = 0;                                   // ticks without a sample that the architecture needs
  std::optional<Nanoseconds> resumed_;                          // its brakes begin to open
  Vector given_;                                                // torques of the tick before
  double shortage_ = 0;  // share of the torques that the law withheld, low-passed
  FollowerReport report_;
  FollowerTotals totals_;
};

}  // namespace forcebound::server
