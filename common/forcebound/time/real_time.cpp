#include "forcebound/time/real_time.hpp"

#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace forcebound::time {

int ask_for_first_in_first_out(int priority) noexcept {
  sched_param parameters{};
  parameters.sched_priority = priority;
  // systemd may have set this flag (CPUSchedulingResetOnFork): without a capability a request that drops it is refused.
  const int kept = sched_getscheduler(0) & SCHED_RESET_ON_FORK;
  return sched_setscheduler(0, SCHED_FIFO | kept, &parameters) == 0 ? 0 : errno;
}

namespace {

/// A sleeping processor takes time to wake up, and a virtual one may be taken away meanwhile. The kernel keeps all
/// processors awake while this file is held open with a zero written to it: as long as the process lives.
/// @returns 0, or the error number of the refusal.
int keep_processors_awake() noexcept {
  static const int kRefused = [] {
    constexpr std::int32_t kWakeUp_us = 0;
    const int held = open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
    return held >= 0 && write(held, &kWakeUp_us, sizeof kWakeUp_us) == sizeof kWakeUp_us ? 0 : errno;
  }();
  return kRefused;
}

}  // namespace

RealTimeGrant ask_for_real_time(int priority) {
  RealTimeGrant grant;
  const int refused = ask_for_first_in_first_out(priority);
  grant.first_in_first_out = refused == 0;
  grant.text = refused == 0 ? "SCHED_FIFO " + std::to_string(priority)
                            : std::string("no SCHED_FIFO (") + std::strerror(refused) + ")";
  grant.memory_locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  grant.text +=
      grant.memory_locked ? ", memory locked" : std::string(", memory not locked (") + std::strerror(errno) + ")";
  if (!grant.first_in_first_out) return grant;
  const int asleep = keep_processors_awake();
  grant.processors_awake = asleep == 0;
  grant.text +=
      asleep == 0 ? ", processors kept awake" : std::string(", processors may sleep (") + std::strerror(asleep) + ")";
  return grant;
}

void touch_stack() noexcept {
  constexpr std::size_t kBytes = 256 * 1024;
  constexpr std::size_t kPage = 4096;
  unsigned char stack[kBytes];
  volatile unsigned char* touched = stack;
  for (std::size_t i = 0; i < kBytes; i += kPage) touched[i] = 0;
}

}  // namespace forcebound::time
