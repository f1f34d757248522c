#include "forcebound/time/real_time.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstddef>
#include <cstring>

namespace forcebound::time {

int ask_for_first_in_first_out(int priority) noexcept {
  sched_param parameters{};
  parameters.sched_priority = priority;
  return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
}

RealTimeGrant ask_for_real_time(int priority) {
  RealTimeGrant grant;
  const int refused = ask_for_first_in_first_out(priority);
  grant.first_in_first_out = refused == 0;
  grant.text = refused == 0 ? "SCHED_FIFO " + std::to_string(priority)
                            : std::string("no SCHED_FIFO (") + std::strerror(refused) + ")";
  grant.memory_locked = mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  grant.text +=
      grant.memory_locked ? ", memory locked" : std::string(", memory not locked (") + std::strerror(errno) + ")";
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
