#include "forcebound/server/follower/follower_thread.hpp"

#include <algorithm>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstdlib>

#include "forcebound/time/heap_operations.hpp"
#include "forcebound/time/periodic_timer.hpp"
#include "forcebound/time/real_time.hpp"
#include "forcebound/time/signal_stack.hpp"

namespace forcebound::server {
namespace {

constexpr std::uint64_t kSettlingTicks = 1000;  // the first second may still touch memory for the first time

bool is_at_rest(FollowerState state) noexcept {
  using enum FollowerState;
  return state == waiting || state == stopped || state == failed;
}

}  // namespace

struct FollowerThread::Changes {
  static constexpr std::size_t kCapacity = 64;
  boost::lockfree::spsc_queue<StateChange> queue{kCapacity};
};

FollowerThread::FollowerThread(std::unique_ptr<Follower> follower, const time::Clock& clock, const Settings& settings)
    : clock_(clock),
      settings_(settings),
      first_(follower->report()),
      changes_(std::make_unique<Changes>()),
      follower_(std::move(follower)),
      state_(first_.state),
      wake_ups_(follower_->period()) {
  follower_->start();
  if (!follower_->robot().is_simulated()) {
    guard_.emplace(follower_->robot(), clock_,
                   settings_.priority ? std::optional(*settings_.priority + 1) : std::nullopt);
  }
  idle_.emplace(clock_, follower_->period(), settings_.priority);
  thread_ = std::jthread([this](const std::stop_token& stopping) { run(stopping); });
  begun_.wait();
}

FollowerThread::~FollowerThread() {
  stop();
  // A thread that is in a call cannot be ended alone, and uses what would be destroyed here.
  if (!over_) std::_Exit(EXIT_FAILURE);
}

void FollowerThread::begin_leader() noexcept {
  input_ = {.leader = input_.leader + 1, .leads = true, .bias_commands = input_.bias_commands};
  inputs_.store(input_);
}

void FollowerThread::leave() noexcept {
  input_ = {.leader = input_.leader + 1, .bias_commands = input_.bias_commands};
  inputs_.store(input_);
}

const FollowerReport& FollowerThread::exchange(const LeaderMotion& motion) noexcept {
  input_.moved = true;
  input_.motion = motion;
  inputs_.store(input_);
  return newest();
}

const FollowerReport& FollowerThread::newest() noexcept {
  if (const FollowerReport* const report = reports_.take()) newest_ = report;
  if (trouble() == RobotGuard::Trouble::none) return *newest_;
  without_robot_ = *newest_;
  without_robot_.state = FollowerState::failed;
  without_robot_.share = 0;
  return without_robot_;
}

void FollowerThread::learn_bias() noexcept {
  ++input_.bias_commands;
  inputs_.store(input_);
}

std::optional<StateChange> FollowerThread::take_change() noexcept {
  StateChange change;
  if (!changes_->queue.pop(change)) return std::nullopt;
  return change;
}

const FollowerThread::Outcome& FollowerThread::stop() {
  if (ended_) return over_ ? outcome_ : lost_;
  ended_ = true;
  thread_.request_stop();
  while (!over_ && !is_lost()) std::this_thread::sleep_for(std::chrono::milliseconds{1});
  if (!over_) {
    lost_.last = FollowerState::failed;
    lost_.idle = idle_->stop();
    return lost_;
  }
  thread_.join();
  guard_.reset();
  outcome_.idle = idle_->stop();
  outcome_.loop = wake_ups_.figures();
  outcome_.totals = follower_->totals();
  return outcome_;
}

void FollowerThread::run(const std::stop_token& stopping) {
  if (settings_.priority) grant_ = time::ask_for_real_time(*settings_.priority).text;
  begun_.count_down();
  time::touch_stack();
  const time::SignalStack stack;
  state_since_ = clock_.now();
  time::PeriodicTimer timer(clock_, follower_->period());
  std::uint64_t ticks = 0;
  std::uint64_t allocations_before = 0;
  Nanoseconds now = timer.wait();
  for (; !stopping.stop_requested(); now = timer.wait()) {
    receive(now);
    tick(now);
    if (++ticks == kSettlingTicks) allocations_before = time::heap_operations_of_this_thread();
  }
  if (ticks > kSettlingTicks) outcome_.allocations = time::heap_operations_of_this_thread() - allocations_before;
  outcome_.last = state_;
  // Nobody leads any more: what moves is stopped by its own brakes.
  follower_->leave();
  last_received_.reset();
  follower_->stop(now);
  const Nanoseconds until = now + settings_.stop_most;
  do {
    tick(now);
    now = timer.wait();
  } while (!is_at_rest(state_) && now < until);
  outcome_.in_state[state_] += now - state_since_;
  outcome_.at_rest = is_at_rest(state_);
  outcome_.missed_ticks = timer.missed();
  if (guard_) guard_->end();
  over_ = true;
}

void FollowerThread::receive(Nanoseconds now) noexcept {
  const Input* const input = inputs_.take();
  if (input == nullptr) return;
  if (input->bias_commands != std::exchange(bias_commands_, input->bias_commands)) follower_->learn_bias(now);
  if (input->leader != leader_) {
    leader_ = input->leader;
    last_received_.reset();
    follower_->begin_leader();
  }
  if (!input->leads || !input->moved) return;
  last_received_ = input->motion.arrived;
  follower_->receive(input->motion);
}

void FollowerThread::tick(Nanoseconds now) noexcept {
  wake_ups_.add(now);
  if (guard_) guard_->store_tick_time(clock_.now());
  follower_->tick(now);
  reports_.store(follower_->report());
  queue_state_change(now);
}

void FollowerThread::queue_state_change(Nanoseconds now) noexcept {
  const FollowerState state = follower_->report().state;
  if (state == state_) return;
  StateChange change{.from = state_,
                     .to = state,
                     .at = now,
                     .lasted = now - state_since_,
                     .silent = last_received_ ? std::optional(now - *last_received_) : std::nullopt,
                     .why_stopped = follower_->totals().why_stopped,
                     .grip_waits = follower_->report().picture.grip_waits,
                     .bias_age = follower_->report().picture.bias_age};
  if (change.by_robot()) {
    const std::string_view error = follower_->last_error();
    std::copy_n(error.begin(), std::min(error.size(), change.robot_error.size() - 1), change.robot_error.begin());
  }
  if (!changes_->queue.push(change)) ++outcome_.changes_lost;
  outcome_.in_state[state_] += change.lasted;
  state_ = state;
  state_since_ = now;
}

}  // namespace forcebound::server
