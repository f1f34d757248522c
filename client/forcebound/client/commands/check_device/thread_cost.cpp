#include "forcebound/client/commands/check_device/thread_cost.hpp"

#include <sys/resource.h>

#include <ctime>

#include "forcebound/time/steady_clock.hpp"

namespace forcebound::client::commands {
namespace {

Nanoseconds processor_time() {
  ::timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::chrono::seconds{time.tv_sec} + Nanoseconds{time.tv_nsec};
}

long voluntary_waits() {
  ::rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nvcsw;
}

}  // namespace

CallCost thread_cost_of(const std::function<void()>& call) {
  const time::SteadyClock clock;
  const long waits_before = voluntary_waits();
  const Nanoseconds processor_before = processor_time();
  const Nanoseconds before = clock.now();
  call();
  return {.wall = clock.now() - before,
          .processor = processor_time() - processor_before,
          .waits = voluntary_waits() - waits_before};
}

}  // namespace forcebound::client::commands
