#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <latch>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "forcebound/control/enum_array.hpp"
#include "forcebound/record/idle_thread.hpp"
#include "forcebound/record/wake_ups.hpp"
#include "forcebound/server/follower/follower.hpp"
#include "forcebound/server/follower/follower_environment.hpp"
#include "forcebound/server/follower/robot_guard.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/time/latest.hpp"

namespace forcebound::server {

/// A robot went from one state to another.
struct StateChange {
  FollowerState from = FollowerState::waiting;
  FollowerState to = FollowerState::waiting;
  Nanoseconds at{0};
  Nanoseconds lasted{0};                  ///< how long it was in the state before
  std::optional<Nanoseconds> silent{};    ///< since the leader was last heard; none: nobody leads
  std::string_view why_stopped{};         ///< last, in a few words; empty: it never did. Static text
  std::array<char, 160> robot_error{};    ///< by the robot, where it failed or stopped by itself; ends with a zero
  bool grip_waits = false;                ///< the gripper, until the operator's own grip has met where it stands
  std::optional<Nanoseconds> bias_age{};  ///< since its force sensor's bias was learned

  /// Whether it was the robot that ended its work.
  [[nodiscard]] bool by_robot() const noexcept {
    return to == FollowerState::failed ||
           (to == FollowerState::stopped && from != FollowerState::stopping && from != FollowerState::failed);
  }
};

/// Ticks a robot on a thread of its own at the robot's period, at absolute times; a simulated robot lives by the same
/// clock. Missed ticks are left out and counted. The thread of the server and that of the robot exchange the newest
/// motion and the newest report without waiting for each other (Latest).
///
/// Beside it runs a thread that only sleeps, to tell the loop's jitter from the machine's. A robot that is not
/// simulated is watched by a RobotGuard: while its driver does not return, its leader is told that the robot has
/// failed.
///
/// All members are called on the thread of the server.
class FollowerThread final : public FollowerRunner {
 public:
  struct Settings {
    std::optional<int> priority{};  ///< SCHED_FIFO and locked memory are asked for; none: as any thread
    Nanoseconds stop_most{std::chrono::seconds{2}};  ///< at the end, the robot comes to rest within that, or is left
  };

  /// What there was, after the end.
  struct Outcome {
    FollowerTotals totals{};
    control::EnumArray<control::FollowerState, Nanoseconds, control::kFollowerStates> in_state{};  ///< how long
    record::IdleTimer loop{};  ///< intervals between the loop's wake-ups
    record::IdleTimer idle{};  ///< of a thread that only slept meanwhile
    std::uint64_t missed_ticks = 0;
    std::uint64_t allocations = 0;   ///< in the loop, without its first second; 0 where nobody counts
    std::uint64_t changes_lost = 0;  ///< of state, that nobody took in time
    bool at_rest = false;            ///< at the end
    FollowerState last{};            ///< before it was brought to rest
  };

  /// Starts robot and thread. @param clock must outlive it
  /// @throws what the robot's start throws; std::system_error if there can be no thread
  FollowerThread(std::unique_ptr<Follower> follower, const time::Clock& clock, const Settings& settings);
  FollowerThread(std::unique_ptr<Follower> follower, const time::Clock& clock)
      : FollowerThread(std::move(follower), clock, Settings{}) {}
  ~FollowerThread() override;
  FollowerThread(const FollowerThread&) = delete;
  FollowerThread& operator=(const FollowerThread&) = delete;

  void begin_leader() noexcept override;
  void leave() noexcept override;
  const FollowerReport& exchange(const LeaderMotion& motion) noexcept override;
  const FollowerReport& newest() noexcept override;

  /// Learn the bias of the robot's force sensor now; the report's `bias` answers.
  void learn_bias() noexcept;

  /// The oldest change of state that was not taken yet.
  [[nodiscard]] std::optional<StateChange> take_change() noexcept;

  /// What the system granted of what `Settings::priority` asked for, in words; empty: nothing was asked for.
  [[nodiscard]] const std::string& grant() const noexcept { return grant_; }

  /// Brings the robot to rest and ends both threads; again: nothing more.
  const Outcome& stop();

  /// What is wrong with the robot's thread. Once it is lost, the process cannot but end, by std::_Exit after `stop`.
  [[nodiscard]] RobotGuard::Trouble trouble() const noexcept {
    return guard_ ? guard_->trouble() : RobotGuard::Trouble::none;
  }
  [[nodiscard]] bool is_lost() const noexcept { return guard_ && guard_->is_lost(); }
  /// Null: a simulated robot has none.
  [[nodiscard]] const RobotGuard* guard() const noexcept { return guard_ ? &*guard_ : nullptr; }

  /// Of the robot, after `stop` only.
  [[nodiscard]] const Follower& follower() const noexcept { return *follower_; }

 private:
  /// By the server to the robot.
  struct Input {
    std::uint64_t leader = 0;  ///< 1, 2, 3, ...; another number, another leader
    bool leads = false;
    bool moved = false;
    LeaderMotion motion{};
    std::uint64_t bias_commands = 0;  ///< to learn the sensor's bias, so far
  };
  struct Changes;

  void run(const std::stop_token& stopping);
  void receive(Nanoseconds now) noexcept;
  void tick(Nanoseconds now) noexcept;
  void queue_state_change(Nanoseconds now) noexcept;

  const time::Clock& clock_;
  Settings settings_;
  std::string grant_;

  // Of the server's thread.
  Input input_;
  FollowerReport first_;
  const FollowerReport* newest_ = &first_;
  FollowerReport without_robot_;
  Outcome lost_;  // in place of what only a thread that ends can tell
  bool ended_ = false;

  // Between the two.
  time::Latest<Input> inputs_;
  time::Latest<FollowerReport> reports_;
  std::unique_ptr<Changes> changes_;
  std::latch begun_{1};
  std::atomic<bool> over_{false};

  // Of the robot's thread, until it has ended.
  std::unique_ptr<Follower> follower_;
  std::uint64_t leader_ = 0;
  std::uint64_t bias_commands_ = 0;
  std::optional<Nanoseconds> last_received_;
  FollowerState state_ = FollowerState::waiting;
  Nanoseconds state_since_{0};
  record::WakeUps wake_ups_;
  Outcome outcome_;

  std::optional<record::IdleThread> idle_;
  std::optional<RobotGuard> guard_;
  std::jthread thread_;
};

}  // namespace forcebound::server
