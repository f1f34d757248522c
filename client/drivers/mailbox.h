/* What two threads of a driver hand to each other: the tick's, which never waits, and the transport's. */
#ifndef FORCEBOUND_DRIVERS_MAILBOX_H
#define FORCEBOUND_DRIVERS_MAILBOX_H

#include <stdint.h>
#include <string.h>

#define MAILBOX_NUMBERS 16

/* The newest numbers that one thread wrote, for one other to read. All zero: empty. */
typedef struct mailbox {
  uint64_t writes; /* twice as many as there were, and one more while one is in progress */
  uint64_t numbers[MAILBOX_NUMBERS];
} mailbox;

static inline void mailbox_write(mailbox* box, const double* numbers, int count) {
  const uint64_t writes = __atomic_load_n(&box->writes, __ATOMIC_RELAXED);
  int i;
  __atomic_store_n(&box->writes, writes + 1, __ATOMIC_RELAXED);
  __atomic_thread_fence(__ATOMIC_RELEASE);
  for (i = 0; i < count; ++i) {
    uint64_t bits;
    memcpy(&bits, &numbers[i], sizeof bits);
    __atomic_store_n(&box->numbers[i], bits, __ATOMIC_RELAXED);
  }
  __atomic_store_n(&box->writes, writes + 2, __ATOMIC_RELEASE);
}

/* Returns how many writes there were, 0 if none, or if one was in progress however often it was looked. */
static inline uint64_t mailbox_read(const mailbox* box, double* numbers, int count) {
  int attempt;
  for (attempt = 0; attempt < 100; ++attempt) {
    const uint64_t before = __atomic_load_n(&box->writes, __ATOMIC_ACQUIRE);
    int i;
    if (before % 2 != 0) continue;
    for (i = 0; i < count; ++i) {
      const uint64_t bits = __atomic_load_n(&box->numbers[i], __ATOMIC_RELAXED);
      memcpy(&numbers[i], &bits, sizeof bits);
    }
    __atomic_thread_fence(__ATOMIC_ACQUIRE);
    if (__atomic_load_n(&box->writes, __ATOMIC_RELAXED) == before) return before / 2;
  }
  return 0;
}

#endif
