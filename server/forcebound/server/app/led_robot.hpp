#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "forcebound/control/law_registry.hpp"
#include "forcebound/server/app/follower_options.hpp"
#include "forcebound/server/environment/environment.hpp"
#include "forcebound/server/robot/task.hpp"
#include "forcebound/server/runtime/follower_thread.hpp"
#include "forcebound/time/clock.hpp"

namespace forcebound::server {

/// The robot that forcebound-server drives: set up by the command line, and told of in log and totals.
class LedRobot {
 public:
  /// Starts the robot and its thread. @param clock must outlive it
  /// @param priority of its thread, SCHED_FIFO; none: as any thread
  /// @throws std::exception with the reason, in a line, why robot, task, architecture and law do not go together
  LedRobot(const FollowerOptions& options, const control::LawRegistry& laws, const time::Clock& clock,
           std::optional<int> priority);

  /// That clients request; its name is the task's, or `robot`.
  [[nodiscard]] EnvironmentKind environment() const;

  /// Robot, task, architecture and law in a line.
  [[nodiscard]] std::string summary() const;

  /// How it looks, and what it reports now for that.
  [[nodiscard]] const FollowerAppearance& appearance() const noexcept { return *appearance_; }
  [[nodiscard]] const FollowerReport& newest() noexcept { return thread_->newest(); }

  /// Logs what changed since the last call.
  void log_changes();

  /// Learn the bias of its force sensor now; what comes of it is logged.
  void learn_bias() noexcept { thread_->learn_bias(); }

  /// Brings the robot to rest, ends its thread, and logs what changed meanwhile. To be called once no client leads it.
  void stop();

  /// Whether its driver hangs or has crashed: the process cannot but end, by std::_Exit after `stop`.
  [[nodiscard]] bool is_lost() const noexcept { return thread_->is_lost(); }
  [[nodiscard]] bool has_crashed() const noexcept { return thread_->trouble() == RobotGuard::Trouble::crashed; }

  /// Of all that the robot did, after `stop`: a line for each subject, not broken.
  [[nodiscard]] std::string totals() const;

 private:
  /// "robot at task", or the robot alone: by its own name, for the settings of its driver are nobody else's business.
  [[nodiscard]] std::string at_work() const;

  FollowerOptions options_;
  std::optional<Task> task_;  ///< none: the robot has work of its own
  std::string name_{};        ///< of the robot
  bool reported_lost_ = false;
  std::uint64_t bias_answers_ = 0;  ///< logged
  std::shared_ptr<FollowerThread> thread_;
  std::shared_ptr<const FollowerAppearance> appearance_;
};

/// Why there is no robot any more, and what became of it.
[[nodiscard]] std::string loss_in_words(const RobotGuard& guard, const std::string& robot);

/// "following -> holding after 12.4 s; the leader was last heard 101 ms ago".
[[nodiscard]] std::string in_words(const StateChange& change);

/// "the sensor's bias is learned again: by 3 N other than before".
[[nodiscard]] std::string in_words(const SensorBias::Status& bias);

/// The numbers of a robot's run, a line for each subject.
[[nodiscard]] std::string in_words(const FollowerThread::Outcome& outcome);

}  // namespace forcebound::server
