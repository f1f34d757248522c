#include "forcebound/server/runtime/robot_guard.hpp"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <ctime>

#include "forcebound/time/real_time.hpp"

namespace forcebound::server {
namespace {

constexpr std::array kCrashes{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
constexpr auto kLook = std::chrono::milliseconds{5};
constexpr int kDyingLooks = 50;  // of 5 ms

std::atomic<RobotGuard*> guarding{nullptr};

void set_handlers(void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_ONSTACK;
  for (const int crash : kCrashes) sigaction(crash, &action, nullptr);
}

}  // namespace

RobotGuard::RobotGuard(device::HapticDevice& robot, const time::Clock& clock, std::optional<int> priority)
    : robot_(robot),
      clock_(clock),
      limit_(std::max(time::from_seconds(robot.facts().hold_s_max), kSlow) +
             time::from_seconds(robot.facts().period_s)),
      priority_(priority),
      stack_(std::make_unique<std::array<std::byte, kStackBytes>>()) {
  guarding = this;
  set_handlers(note_crash);
  thread_ = std::jthread([this](const std::stop_token& stopping) { run(stopping); });
}

RobotGuard::~RobotGuard() {
  set_handlers(SIG_DFL);
  guarding = nullptr;
}

void RobotGuard::watch_this_thread() {
  stack_t stack{};
  stack.ss_sp = stack_->data();
  stack.ss_size = stack_->size();
  sigaltstack(&stack, &stack_before_);
  loop_thread_ = ::gettid();
}

void RobotGuard::end() noexcept {
  began_.store(0, std::memory_order_relaxed);
  if (::gettid() == loop_thread_) sigaltstack(&stack_before_, nullptr);
}

RobotGuard::Trouble RobotGuard::trouble() const noexcept {
  if (signal_ != 0) return Trouble::crashed;
  const Nanoseconds since = since_tick();
  if (since > kStuck) return Trouble::stuck;
  return since > limit_ ? Trouble::slow : Trouble::none;
}

bool RobotGuard::is_lost() const noexcept {
  // What crashes does so in a tick, or a period later at most.
  if (signal_ != 0) return stopped_after_crash_ || since_tick() > kStopMost;
  return trouble() == Trouble::stuck;
}

Nanoseconds RobotGuard::since_tick() const noexcept {
  const std::int64_t began = began_.load(std::memory_order_relaxed);
  return began == 0 ? Nanoseconds{0} : clock_.now() - Nanoseconds{began};
}

/// Only what a signal handler may call.
void RobotGuard::note_crash(int number) {
  RobotGuard* const guard = guarding;
  if (guard != nullptr && ::gettid() == guard->loop_thread_) {
    // What it holds, such as locks, stays as it is; nobody needs this thread any more.
    guard->signal_ = number;
    for (;;) ::pause();
  }
  constexpr timespec kWait{.tv_sec = 0, .tv_nsec = Nanoseconds(kLook).count()};
  if (guard != nullptr) {
    guard->stopped_ = false;
    guard->dying_ = true;
    for (int i = 0; i < kDyingLooks && !guard->stopped_; ++i) ::nanosleep(&kWait, nullptr);
  }
  std::signal(number, SIG_DFL);
  std::raise(number);
}

void RobotGuard::run(const std::stop_token& stopping) {
  if (priority_) (void)time::ask_for_first_in_first_out(*priority_);
  std::int64_t stopped_after = 0;
  bool crash_seen = false;
  while (!stopping.stop_requested()) {
    std::this_thread::sleep_for(kLook);
    const Trouble now = trouble();
    const std::int64_t began = began_.load(std::memory_order_relaxed);
    const bool slow = now != Trouble::none && began != stopped_after;
    const bool crashed = (now == Trouble::crashed || dying_) && !crash_seen;
    // Such as for a lock that the lost thread holds.
    if (since_tick() > kStuck + kEnds) ::_exit(EXIT_FAILURE);
    if (!slow && !crashed) continue;
    stopped_after = began;
    crash_seen = crash_seen || crashed;
    stop_robot();
    stopped_after_crash_ = crash_seen;
  }
}

void RobotGuard::stop_robot() {
  stopped_ = false;
  robot_.stop(clock_.now());
  stopped_ = true;
}

}  // namespace forcebound::server
