#include "forcebound/client/runtime/idle_timer.hpp"

#include "forcebound/time/periodic_timer.hpp"
#include "forcebound/time/real_time.hpp"

namespace forcebound::client {

IdleTimer::IdleTimer(const time::Clock& clock, time::Nanoseconds period, int priority)
    : period_(period),
      thread_([this, &clock, priority](const std::stop_token& stopping) { run(stopping, clock, priority); }) {}

record::IdleTimer IdleTimer::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  const auto in_us = [](double ns) { return ns * 1e-3; };
  return {.wake_ups = intervals_ns_.count(),
          .late = late_,
          .p50_us = in_us(intervals_ns_.percentile(0.5)),
          .p99_us = in_us(intervals_ns_.percentile(0.99)),
          .p999_us = in_us(intervals_ns_.percentile(0.999)),
          .max_us = in_us(intervals_ns_.max())};
}

void IdleTimer::run(const std::stop_token& stopping, const time::Clock& clock, int priority) {
  time::ask_for_real_time(priority);
  time::PeriodicTimer timer(clock, period_);
  time::Nanoseconds previous = timer.wait();
  while (!stopping.stop_requested()) {
    const time::Nanoseconds now = timer.wait();
    intervals_ns_.add((now - previous).count());
    if (now - previous > period_ + record::kLateBy) ++late_;
    previous = now;
  }
}

}  // namespace forcebound::client
