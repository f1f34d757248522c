#include "forcebound/server/follower/robot_guard.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "forcebound/time/real_time.hpp"

namespace forcebound::server {
namespace {

constexpr auto kLook = std::chrono::milliseconds{5};

}  // namespace

RobotGuard::RobotGuard(device::HapticDevice& robot, const time::Clock& clock, std::optional<int> priority)
    : robot_(robot),
      clock_(clock),
      limit_(std::max(time::from_seconds(robot.facts().hold_s_max), kSlow) +
             time::from_seconds(robot.facts().period_s)),
      priority_(priority),
      thread_([this](const std::stop_token& stopping) { run(stopping); }) {}

RobotGuard::Trouble RobotGuard::trouble() const noexcept {
  if (!robot_.crash().empty()) return Trouble::crashed;
  const Nanoseconds since = since_tick();
  if (since > kStuck) return Trouble::stuck;
  return since > limit_ ? Trouble::slow : Trouble::none;
}

Nanoseconds RobotGuard::since_tick() const noexcept {
  const std::int64_t began = began_.load(std::memory_order_relaxed);
  return began == 0 ? Nanoseconds{0} : clock_.now() - Nanoseconds{began};
}

void RobotGuard::run(const std::stop_token& stopping) {
  if (priority_) (void)time::ask_for_first_in_first_out(*priority_);
  std::int64_t stopped_after = 0;
  while (!stopping.stop_requested()) {
    std::this_thread::sleep_for(kLook);
    const Nanoseconds since = since_tick();
    const std::int64_t began = began_.load(std::memory_order_relaxed);
    // Such as for a lock that the lost thread holds.
    if (since > kStuck + kEnds) ::_exit(EXIT_FAILURE);
    if (since <= limit_ || began == stopped_after) continue;
    stopped_after = began;
    stop_robot();
  }
}

void RobotGuard::stop_robot() {
  stopped_ = false;
  robot_.stop(clock_.now());
  stopped_ = true;
}

}  // namespace forcebound::server
