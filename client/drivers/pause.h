/* Time of the threads of drivers. */
#ifndef FORCEBOUND_DRIVERS_PAUSE_H
#define FORCEBOUND_DRIVERS_PAUSE_H

#include <time.h>

static inline double now_s(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Less than a second. */
static inline void rest(long ns) {
  const struct timespec pause = {.tv_sec = 0, .tv_nsec = ns};
  nanosleep(&pause, NULL);
}

#endif
