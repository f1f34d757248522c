#include "forcebound/client/runtime/tick_loop.hpp"

#include "forcebound/client/runtime/priority.hpp"
#include "forcebound/time/heap_operations.hpp"
#include "forcebound/time/periodic_timer.hpp"
#include "forcebound/time/real_time.hpp"
#include "forcebound/time/signal_stack.hpp"

namespace forcebound::client {
namespace {

constexpr Nanoseconds kOncePatience = std::chrono::seconds{5};
constexpr Nanoseconds kClosing = std::chrono::seconds{3};
constexpr int kSettlingTicks = 1000;  // the first second may still touch memory for the first time

}  // namespace

void TickLoop::run() {
  grant_.set(time::ask_for_real_time(kTickPriority).text);
  time::touch_stack();
  const time::SignalStack stack;
  const Nanoseconds start = clock_.now();
  time::PeriodicTimer timer(clock_, settings_.period);
  std::uint64_t ticks = 0;
  std::uint64_t allocations_at_start = 0;
  for (Nanoseconds now = timer.wait(); !stop_ && !ended_ && !over(now - start); now = timer.wait()) {
    ++rounds_;
    session_.tick(now);
    if (settings_.way != nullptr && session_.state() == SessionState::active) settings_.way->keep();
    if (settings_.watchdog != nullptr) settings_.watchdog->store_tick_time(clock_.now());
    if (++ticks == kSettlingTicks) allocations_at_start = time::heap_operations_of_this_thread();
  }
  if (ticks > kSettlingTicks) outcome_.allocations = time::heap_operations_of_this_thread() - allocations_at_start;
  outcome_.missed_ticks = timer.missed();
  // The device has zero force from the first call of `close` on.
  if (settings_.watchdog != nullptr) settings_.watchdog->rest();
  const Nanoseconds closing = clock_.now();
  for (Nanoseconds now = timer.wait(); !session_.close(now) && now - closing < kClosing; now = timer.wait()) {
    ++rounds_;
  }
  done_ = true;
}

bool TickLoop::over(Nanoseconds elapsed) noexcept {
  const bool ended = settings_.duration_s > 0 && time::to_seconds(elapsed) >= settings_.duration_s;
  const bool no_session_yet = session_.state() == SessionState::connecting;
  const bool unanswered = settings_.once && no_session_yet && (ended || elapsed > kOncePatience);
  const bool refused = session_.refused() && (settings_.once || (no_session_yet && !settings_.asks_again));
  outcome_.gave_up = refused || unanswered;
  return outcome_.gave_up || ended;
}

}  // namespace forcebound::client
