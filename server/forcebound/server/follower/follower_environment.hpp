#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "forcebound/server/follower/follower.hpp"
#include "forcebound/server/follower/follower_appearance.hpp"
#include "forcebound/server/offer/environment.hpp"

namespace forcebound::server {

/// Who lets time pass for a robot: a thread of its own beside a server, or the calls themselves where time is virtual.
///
/// All members are called on the thread of the server.
class FollowerRunner {
 public:
  virtual ~FollowerRunner() = default;

  /// Another leader takes the robot; its first motion comes next.
  virtual void begin_leader() noexcept = 0;
  virtual void leave() noexcept = 0;

  /// The robot hears of a motion, and the newest that it reports. Real time: does not wait.
  virtual const FollowerReport& exchange(const LeaderMotion& motion) noexcept = 0;

  /// The newest that it reports. Real time: does not wait.
  virtual const FollowerReport& newest() noexcept = 0;
};

/// Ticks a robot up to the times it is told: the robot's past never depends on what comes later. For virtual time
/// alone: after a pause it makes up for all of it at once.
class StepwiseRunner final : public FollowerRunner {
 public:
  /// @param now when the robot starts; it ticks at whole periods from there
  /// @throws what the robot's start throws
  StepwiseRunner(std::shared_ptr<Follower> follower, Nanoseconds now);

  void begin_leader() noexcept override { follower_->begin_leader(); }
  void leave() noexcept override { follower_->leave(); }
  const FollowerReport& exchange(const LeaderMotion& motion) noexcept override;
  const FollowerReport& newest() noexcept override { return follower_->report(); }

  /// All ticks up to that time.
  void live_until(Nanoseconds time) noexcept;

 private:
  std::shared_ptr<Follower> follower_;
  Nanoseconds next_;
};

/// The environment that a robot is: one leader at a time. A leader that was silent until the robot stopped loses it to
/// the next who asks; if it comes back, it has the robot again once that one has left.
/// @param name that clients request; @param degrees_of_freedom that its task needs of a leader at least, 1 to 3
/// @param simulated in a line: what robot, at which work, with which architecture and law
/// @param looks of the robot, as long as the runner lives; null: it is not to be seen
[[nodiscard]] EnvironmentKind follower_environment(std::string name, std::string simulated, int degrees_of_freedom,
                                                   std::shared_ptr<FollowerRunner> runner,
                                                   std::shared_ptr<const FollowerAppearance> appearance = nullptr);

}  // namespace forcebound::server
