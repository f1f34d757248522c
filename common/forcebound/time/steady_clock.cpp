#include "forcebound/time/steady_clock.hpp"

#include <ctime>

namespace forcebound::time {
namespace {

Nanoseconds read(clockid_t id) noexcept {
  timespec t{};
  clock_gettime(id, &t);
  return std::chrono::seconds{t.tv_sec} + Nanoseconds{t.tv_nsec};
}

}  // namespace

Nanoseconds SteadyClock::now() const noexcept { return read(CLOCK_MONOTONIC); }

Nanoseconds wall_clock_now() noexcept { return read(CLOCK_REALTIME); }

}  // namespace forcebound::time
