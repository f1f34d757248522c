#include "forcebound/time/periodic_timer.hpp"

#include <cerrno>
#include <ctime>
#include <stdexcept>
#include <string>

namespace forcebound::time {
namespace {

void sleep_until(Nanoseconds when) noexcept {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(when);
  timespec t{};
  t.tv_sec = static_cast<time_t>(seconds.count());
  t.tv_nsec = static_cast<long>((when - seconds).count());
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

}  // namespace

PeriodicTimer::PeriodicTimer(const Clock& clock, Nanoseconds period)
    : clock_(clock), period_(period), due_(clock.now()) {
  if (period <= Nanoseconds::zero()) {
    throw std::invalid_argument("period must be > 0 ns, got " + std::to_string(period.count()));
  }
}

Nanoseconds PeriodicTimer::wait() noexcept {
  due_ += period_;
  const Nanoseconds before = clock_.now();
  if (before >= due_ + period_) {
    const auto missed = (before - due_) / period_;
    due_ += missed * period_;
    missed_ += static_cast<std::uint64_t>(missed);
  }
  sleep_until(due_);
  return clock_.now();
}

}  // namespace forcebound::time
