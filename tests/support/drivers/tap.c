/* A driver that stands between the client and another one and writes down what passes:
 *
 *   driver=PATH   the other one's file; it gets all other settings
 *   log=PATH      written when the device is closed: a row for each read and the command after it
 *
 * Rows: read_at_s (of CLOCK_MONOTONIC), read_us (how long it took), read (what it returned), command_at_s, command_us,
 * force_x_N, force_y_N, force_z_N. In the tick it only fills memory that is there.
 */
#define _POSIX_C_SOURCE 199309L
#include <dlfcn.h>
#include <forcebound/driver/forcebound_device.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define ROWS 1000000 /* 1000 s at 1 kHz */
#define SETTINGS 16

typedef struct row {
  int64_t read_ns;
  int64_t read_took_ns;
  int64_t command_ns;
  int64_t command_took_ns;
  int result;
  double force_N[3];
} row;

struct forcebound_device {
  const forcebound_driver* driver;
  forcebound_device* device;
  char log[1024];
  row* rows;
  long count;
};

static int64_t now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return 1000000000 * (int64_t)now.tv_sec + now.tv_nsec;
}

static const forcebound_driver* driver_at(const char* path, char* error, size_t error_bytes) {
  const forcebound_driver* (*entry)(uint32_t) = NULL;
  void* const library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (library != NULL) *(void**)&entry = dlsym(library, "forcebound_driver_entry");
  if (entry == NULL) {
    snprintf(error, error_bytes, "driver=%.150s is no driver", path);
    return NULL;
  }
  return entry(FORCEBOUND_DEVICE_INTERFACE);
}

static int tap_open(const forcebound_setting* settings, size_t count, forcebound_device** opened, char* error,
                    size_t error_bytes) {
  forcebound_setting others[SETTINGS];
  size_t others_count = 0;
  size_t i;
  forcebound_device* const tap = calloc(1, sizeof *tap);
  for (i = 0; i < count && others_count < SETTINGS; ++i) {
    if (strcmp(settings[i].key, "driver") == 0) {
      tap->driver = driver_at(settings[i].value, error, error_bytes);
    } else if (strcmp(settings[i].key, "log") == 0) {
      snprintf(tap->log, sizeof tap->log, "%s", settings[i].value);
    } else {
      others[others_count++] = settings[i];
    }
  }
  if (tap->driver == NULL ||
      tap->driver->open(others, others_count, &tap->device, error, error_bytes) != FORCEBOUND_OK) {
    free(tap);
    return FORCEBOUND_FAILED;
  }
  tap->rows = malloc(ROWS * sizeof *tap->rows);
  memset(tap->rows, 1, ROWS * sizeof *tap->rows); /* touched now, so that the tick meets no page fault */
  *opened = tap;
  return FORCEBOUND_OK;
}

static int tap_describe(forcebound_device* tap, forcebound_facts* facts) {
  return tap->driver->describe(tap->device, facts);
}

static int tap_start(forcebound_device* tap) { return tap->driver->start(tap->device); }

static int tap_read(forcebound_device* tap, int64_t at_ns, forcebound_reading* reading) {
  const int64_t before_ns = now_ns();
  const int result = tap->driver->read(tap->device, at_ns, reading);
  if (tap->count < ROWS) {
    row* const now = &tap->rows[tap->count];
    memset(now, 0, sizeof *now);
    now->read_ns = before_ns;
    now->read_took_ns = now_ns() - before_ns;
    now->result = result;
  }
  return result;
}

static int tap_command(forcebound_device* tap, const forcebound_command* command) {
  const int64_t before_ns = now_ns();
  const int result = tap->driver->command(tap->device, command);
  if (tap->count < ROWS) {
    row* const now = &tap->rows[tap->count++];
    now->command_ns = before_ns;
    now->command_took_ns = now_ns() - before_ns;
    memcpy(now->force_N, command->force_N, sizeof now->force_N);
  }
  return result;
}

static void tap_stop(forcebound_device* tap) { tap->driver->stop(tap->device); }

static void tap_close(forcebound_device* tap) {
  FILE* const log = tap->log[0] != '\0' ? fopen(tap->log, "w") : NULL;
  long i;
  tap->driver->close(tap->device);
  if (log != NULL) {
    fputs("read_at_s,read_us,read,command_at_s,command_us,force_x_N,force_y_N,force_z_N\n", log);
    for (i = 0; i < tap->count; ++i) {
      const row* const now = &tap->rows[i];
      fprintf(log, "%.9f,%.3f,%d,%.9f,%.3f,%.9g,%.9g,%.9g\n", 1e-9 * (double)now->read_ns,
              1e-3 * (double)now->read_took_ns, now->result, 1e-9 * (double)now->command_ns,
              1e-3 * (double)now->command_took_ns, now->force_N[0], now->force_N[1], now->force_N[2]);
    }
    fclose(log);
  }
  free(tap->rows);
  free(tap);
}

static const char* tap_last_error(forcebound_device* tap) { return tap->driver->last_error(tap->device); }

static const forcebound_driver kTap = {
    .size = sizeof kTap,
    .interface_version = FORCEBOUND_DEVICE_INTERFACE,
    .name = "tap",
    .description = "writes down what passes between the client and another driver, for tests",
    .settings = "  driver=PATH  the other driver's file\n"
                "  log=PATH     what passed\n",
    .open = tap_open,
    .describe = tap_describe,
    .start = tap_start,
    .read = tap_read,
    .command = tap_command,
    .stop = tap_stop,
    .close = tap_close,
    .last_error = tap_last_error,
};

const forcebound_driver* forcebound_driver_entry(uint32_t wanted) {
  (void)wanted;
  return &kTap;
}
