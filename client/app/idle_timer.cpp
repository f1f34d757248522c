#include "forcebound/client/app/idle_timer.hpp"

#include "forcebound/time/periodic_timer.hpp"
#include "forcebound/time/real_time.hpp"

namespace forcebound::client {

IdleTimer::IdleTimer(const time::Clock& clock, time::Nanoseconds period, int priority)
    : thread_([this, &clock, period, priority](const std::stop_token& stopping) {
        run(stopping, clock, period, priority);
      }) {}

const record::Histogram& IdleTimer::stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  return intervals_ns_;
}

void IdleTimer::run(const std::stop_token& stopping, const time::Clock& clock, time::Nanoseconds period, int priority) {
  time::ask_for_real_time(priority);
  std::this_thread::sleep_for(period / 2);
  time::PeriodicTimer timer(clock, period);
  time::Nanoseconds previous = timer.wait();
  while (!stopping.stop_requested()) {
    const time::Nanoseconds now = timer.wait();
    intervals_ns_.add((now - previous).count());
    previous = now;
  }
}

}  // namespace forcebound::client
