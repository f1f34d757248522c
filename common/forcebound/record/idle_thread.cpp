#include "forcebound/record/idle_thread.hpp"

#include "forcebound/time/periodic_timer.hpp"
#include "forcebound/time/real_time.hpp"

namespace forcebound::record {

IdleThread::IdleThread(const time::Clock& clock, time::Nanoseconds period, std::optional<int> priority)
    : period_(period),
      wake_ups_(period),
      thread_([this, &clock, priority](const std::stop_token& stopping) { run(stopping, clock, priority); }) {}

IdleTimer IdleThread::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  return wake_ups_.figures();
}

void IdleThread::run(const std::stop_token& stopping, const time::Clock& clock, std::optional<int> priority) {
  if (priority) time::ask_for_real_time(*priority);
  time::PeriodicTimer timer(clock, period_);
  while (!stopping.stop_requested()) wake_ups_.add(timer.wait());
}

}  // namespace forcebound::record
