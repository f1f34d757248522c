/* What two threads of a driver hand to each other: the tick's, which never waits, and the transport's. */
#ifndef FORCEBOUND_DRIVERS_MAILBOX_H
#define FORCEBOUND_DRIVERS_MAILBOX_H

#include <stdint.h>
#include <string.h>

#define MAILBOX_NUMBERS 16

/* The newest numbers that one thread wrote, for one other to read. All zero: empty.
 *
 * Each number is released after the count was made odd, and acquired before the count is looked at again: who read a
 * number of a later write sees that there was one. Fences would say the same, but ThreadSanitizer does not know them. */
typedef struct mailbox {
  uint64_t writes; /* twice as many as there were, and one more while one is in progress */
  uint64_t numbers[MAILBOX_NUMBERS];
} mailbox;

static inline void mailbox_write(mailbox* box, const double* numbers, int count) {
  const uint64_t writes = __atomic_load_n(&box->writes, __ATOMIC_RELAXED);
  int i;
  __atomic_store_n(&box->writes, writes + 1, __ATOMIC_RELAXED);
  for (i = 0; i < count; ++i) {
    uint64_t bits;
    memcpy(&bits, &numbers[i], sizeof bits);
    __atomic_store_n(&box->numbers[i], bits, __ATOMIC_RELEASE);
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
      const uint64_t bits = __atomic_load_n(&box->numbers[i], __ATOMIC_ACQUIRE);
      memcpy(&numbers[i], &bits, sizeof bits);
    }
    if (__atomic_load_n(&box->writes, __ATOMIC_RELAXED) == before) return before / 2;
  }
  return 0;
}

#define MAILBOX_SLOTS 4

/* As a mailbox, but the newest two that were not read yet, in their order: where both threads run at the same rate, one
 * that is a little late misses none. All zero: empty. */
typedef struct mailbox_queue {
  uint64_t written;
  uint64_t taken; /* the reader's */
  mailbox slots[MAILBOX_SLOTS];
} mailbox_queue;

static inline void mailbox_queue_write(mailbox_queue* queue, const double* numbers, int count) {
  const uint64_t written = __atomic_load_n(&queue->written, __ATOMIC_RELAXED);
  mailbox_write(&queue->slots[written % MAILBOX_SLOTS], numbers, count);
  __atomic_store_n(&queue->written, written + 1, __ATOMIC_RELEASE);
}

/* 0: there is nothing new. */
static inline int mailbox_queue_read(mailbox_queue* queue, double* numbers, int count) {
  const uint64_t written = __atomic_load_n(&queue->written, __ATOMIC_ACQUIRE);
  if (written == queue->taken) return 0;
  if (written - queue->taken > 2) queue->taken = written - 2;
  return mailbox_read(&queue->slots[queue->taken++ % MAILBOX_SLOTS], numbers, count) != 0;
}

static inline void mailbox_queue_forget(mailbox_queue* queue) {
  queue->taken = __atomic_load_n(&queue->written, __ATOMIC_ACQUIRE);
}

#endif
