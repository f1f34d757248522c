/* Touch, Touch X and Phantom devices, through the HDAPI of OpenHaptics, libHD, which is looked for when the device is
 * opened.
 *
 * Order of calls, axes, calibration and which errors end the scheduling as in omni_common/src/omni_state.cpp of
 * github.com/bharatm11/Geomagic_Touch_ROS_Drivers; the interface is in libhd.h.
 *
 * The half that talks to libHD is in openhaptics_rounds.h. It is in a process of its own unless told otherwise, since
 * libHD itself ends no force once the process is gone that called it.
 *
 * libHD's frame has x to the user's right, y up, z towards him, in millimetres; the scene's y is libHD's -z, its z
 * libHD's y. The columns of a transform follow one another.
 *
 * Never tried on hardware: tested against a library with these functions and a simulated device behind them.
 */
#define _GNU_SOURCE
#include <errno.h>
#include <forcebound/driver/forcebound_device.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "openhaptics_rounds.h"
#include "setting_number.h"

/* What one half asks of the other. */
enum { kWishOpen = 'o', kWishStart = 's', kWishClose = 'c' };
static const int kOpenMost_ms = 10000;
static const int kStartMost_ms = 30000;
static const int kCloseMost_ms = 3000;
static const int kLastRoundsMost = 100;

/* Distance of two neighbouring readings as published, of models whose name has this in it, the longer names first. */
typedef struct model {
  const char* has;
  double step_m;
} model;
static const model kModels[] = {{"Touch X", 2.3e-5}, {"Touch", 5.5e-5},   {"Omni", 5.5e-5},
                                {"Desktop", 2.3e-5}, {"Premium", 3e-5}};
static const double kStep_m = 1e-4;

/* Of the half that talks to libHD. */
static int open_here(forcebound_device* device) {
  const char* model = NULL;
  const char* serial = NULL;
  unsigned int code;
  device->handle = HD_NO_HANDLE;
  if (!hd_look_up(&device->hd, device->library[0] != '\0' ? device->library : NULL, device->error,
                  sizeof device->error)) {
    return FORCEBOUND_FAILED;
  }
  code = open_at_library(device);
  if (code != kHdSuccess) {
    snprintf(device->error, sizeof device->error,
             "libHD finds no device '%.80s': %.80s (0x%04x); devices get their names in 3D Systems' Touch Setup",
             device->wanted[0] != '\0' ? device->wanted : "Default Device", hd_in_words(&device->hd, code), code);
    return FORCEBOUND_FAILED;
  }
  model = device->hd.get_string(kHdModel);
  serial = device->hd.get_string(kHdSerialNumber);
  snprintf(device->name, sizeof device->name, "%.100s%s%.100s", model != NULL ? model : "device of OpenHaptics",
           serial != NULL && *serial != '\0' ? " " : "", serial != NULL ? serial : "");
  if (device->force_N_max == 0) device->hd.get_double(kHdForceMost, &device->force_N_max);
  device->hd.get_double(kHdForceContinuous, &device->force_N_continuous);
  (void)hd_first_error(&device->hd);
  return FORCEBOUND_OK;
}

static int start_here(forcebound_device* device) {
  const unsigned int code = begin_rounds(device);
  if (code != kHdSuccess) {
    snprintf(device->error, sizeof device->error, "forces cannot be switched on: %s (0x%04x)",
             hd_in_words(&device->hd, code), code);
    end_rounds(device);
    return FORCEBOUND_FAILED;
  }
  device->runs = 1;
  if (pthread_create(&device->keeper, NULL, keep, device) != 0) {
    snprintf(device->error, sizeof device->error, "no thread for the device");
    device->runs = 0;
    end_rounds(device);
    return FORCEBOUND_FAILED;
  }
  return FORCEBOUND_OK;
}

static void close_here(forcebound_device* device) {
  if (device->hd.library == NULL) return;
  set(&device->ending, 1);
  if (device->runs) {
    int i;
    pthread_join(device->keeper, NULL);
    /* A last round with zero force, unless there are no rounds any more. */
    for (i = 0; i < kLastRoundsMost && !is_set(&device->ended); ++i) {
      if (__atomic_load_n(&device->lost, __ATOMIC_ACQUIRE) != kHdSuccess) break;
      rest(kRound_ns);
    }
    end_rounds(device);
  }
  if (device->handle != HD_NO_HANDLE) disable(device);
  dlclose(device->hd.library);
  device->hd.library = NULL;
}

static int serve(void* of, char wish) {
  forcebound_device* const device = of;
  if (wish == kWishOpen) return open_here(device);
  if (wish == kWishStart) return start_here(device);
  close_here(device);
  return FORCEBOUND_OK;
}

/* Of the half that the client calls. */
static int ask(forcebound_device* device, char wish, int limit_ms) {
  int result;
  if (device->process.socket < 0) return serve(device, wish);
  result = own_process_ask(&device->process, wish, limit_ms);
  if (result >= 0) return result;
  snprintf(device->error, sizeof device->error, "libHD ended its process, or did not answer within %d s",
           limit_ms / 1000);
  return FORCEBOUND_FAILED;
}

static void give_up(forcebound_device* device) {
  if (device->process.socket >= 0) {
    own_process_end(&device->process, kCloseMost_ms);
  } else {
    close_here(device);
  }
  munmap(device, sizeof *device);
}

/* 0: a setting is not accepted. */
static int read_settings(forcebound_device* device, const forcebound_setting* settings, size_t count, int* own, char* error,
                         size_t error_bytes) {
  size_t i;
  for (i = 0; i < count; ++i) {
    const char* const key = settings[i].key;
    const char* const value = settings[i].value;
    double number = 0;
    const int is_number = setting_number(value, &number);
    if (strcmp(key, "library") == 0 && *value != '\0' && strlen(value) < sizeof device->library) {
      strcpy(device->library, value);
    } else if (strcmp(key, "process") == 0 && (strcmp(value, "own") == 0 || strcmp(value, "same") == 0)) {
      *own = value[0] == 'o';
    } else if (strcmp(key, "name") == 0 && *value != '\0' && strlen(value) < sizeof device->wanted) {
      strcpy(device->wanted, value);
    } else if (strcmp(key, "force_N_max") == 0 && is_number && number > 0 && number <= 100) {
      device->force_N_max = number;
    } else {
      snprintf(error, error_bytes,
               "'%s=%s' is not accepted; accepted are name=NAME, force_N_max=N up to 100, library=PATH and process=own or "
               "same",
               key, value);
      return 0;
    }
  }
  return 1;
}

static int hd_open(const forcebound_setting* settings, size_t count, forcebound_device** opened, char* error,
                   size_t error_bytes) {
  int own = 1;
  forcebound_device* const device = own_process_memory(sizeof *device);
  if (device == NULL) return FORCEBOUND_FAILED;
  device->process.socket = -1;
  if (!read_settings(device, settings, count, &own, error, error_bytes)) {
    give_up(device);
    return FORCEBOUND_FAILED;
  }
  if (own && !own_process_begin(&device->process, serve, device, kWishClose)) {
    snprintf(error, error_bytes, "no process for libHD (%s); process=same needs none", strerror(errno));
    give_up(device);
    return FORCEBOUND_FAILED;
  }
  if (ask(device, kWishOpen, kOpenMost_ms) != FORCEBOUND_OK) {
    snprintf(error, error_bytes, "%.*s", (int)sizeof device->error - 1, device->error);
    give_up(device);
    return FORCEBOUND_FAILED;
  }
  *opened = device;
  return FORCEBOUND_OK;
}

static int hd_describe(forcebound_device* device, forcebound_facts* facts) {
  double step_m = kStep_m;
  size_t i;
  for (i = 0; i < sizeof kModels / sizeof *kModels; ++i) {
    if (strcasestr(device->name, kModels[i].has) == NULL) continue;
    step_m = kModels[i].step_m;
    break;
  }
  facts->degrees_of_freedom = 3;
  snprintf(facts->name, sizeof facts->name, "%s", device->name);
  facts->identified = 0; /* its maker publishes no lower bounds of damping and friction */
  facts->period_s = 1e-3;
  for (i = 0; i < 3; ++i) {
    facts->damping[4 * i] = 0.2;
    facts->encoder_step[i] = step_m;
  }
  facts->force_N_max = device->force_N_max;
  facts->hold_s_max = kHold_s + 1e-9 * (double)kRound_ns;
  facts->latency_s = 2e-9 * (double)kRound_ns;
  facts->stamp_s_most = 1e-9 * (double)kRound_ns;
  if (facts->size >= offsetof(forcebound_facts, force_N_continuous) + sizeof facts->force_N_continuous) {
    facts->force_N_continuous = device->force_N_continuous;
  }
  return FORCEBOUND_OK;
}

static int hd_start(forcebound_device* device) {
  return device->runs ? FORCEBOUND_OK : ask(device, kWishStart, kStartMost_ms);
}

static int fail_as_calibrated(forcebound_device* device) {
  snprintf(device->error, sizeof device->error, "%.100s was calibrated anew: its position may have jumped", device->name);
  return FORCEBOUND_FAILED;
}

static int hd_read(forcebound_device* device, int64_t now_ns, forcebound_reading* reading) {
  double newest[kReadingNumbers];
  const unsigned int lost = __atomic_load_n(&device->lost, __ATOMIC_ACQUIRE);
  unsigned int fault;
  if (lost != kHdSuccess) {
    mailbox_queue_forget(&device->readings);
    snprintf(device->error, sizeof device->error, "%.150s does not answer (libHD's error 0x%04x); looking for it",
             device->name, lost);
    return FORCEBOUND_UNPLUGGED;
  }
  /* Not with the readings, of which a slow tick misses some. */
  fault = __atomic_exchange_n(&device->fault, 0, __ATOMIC_ACQ_REL);
  if (fault == kHdCalibrationNeedsUpdate) return fail_as_calibrated(device);
  if (fault != 0) {
    snprintf(device->error, sizeof device->error, "%.100s gives no force: %.80s (0x%04x)", device->name,
             hd_force_error_in_words(fault), fault);
    return FORCEBOUND_FAILED;
  }
  if (!mailbox_queue_read(&device->readings, newest, kReadingNumbers)) {
    if (device->process.socket < 0 || !own_process_is_gone(&device->process)) return FORCEBOUND_STALE;
    snprintf(device->error, sizeof device->error, "the process that has %.150s ended", device->name);
    return FORCEBOUND_UNPLUGGED;
  }
  if (newest[kFault] == kHdCalibrationNeedsHand) {
    snprintf(device->error, sizeof device->error, "%.150s must be calibrated: put its stylus into the inkwell",
             device->name);
    return FORCEBOUND_FAILED;
  }
  if (newest[kFault] != 0) return fail_as_calibrated(device);
  reading->latched_ns = (int64_t)(1e9 * newest[kLatched]);
  if (reading->latched_ns > now_ns) reading->latched_ns = now_ns; /* it came after the tick began */
  memcpy(reading->position_m, newest + kX, 3 * sizeof *newest);
  memcpy(reading->orientation, newest + kQuaternion, 4 * sizeof *newest);
  reading->buttons = (uint32_t)newest[kButtons];
  reading->has = FORCEBOUND_HAS_BUTTONS | FORCEBOUND_HAS_ORIENTATION;
  return FORCEBOUND_OK;
}

static int hd_command(forcebound_device* device, const forcebound_command* command) {
  const double numbers[kCommandNumbers] = {1e-9 * (double)command->at_ns, command->force_N[0], command->force_N[1],
                                           command->force_N[2]};
  mailbox_write(&device->commands, numbers, kCommandNumbers);
  set(&device->stopping, 0);
  return FORCEBOUND_OK;
}

static void hd_stop(forcebound_device* device) { set(&device->stopping, 1); }

static void hd_close(forcebound_device* device) { give_up(device); }

static const char* hd_last_error(forcebound_device* device) { return device->error; }

static const forcebound_driver kOpenHaptics = {
    .size = sizeof kOpenHaptics,
    .interface_version = FORCEBOUND_DEVICE_INTERFACE,
    .name = "openhaptics",
    .description = "Touch, Touch X and Phantom, by OpenHaptics' libHD",
    .settings = "  name=NAME      as in Touch Setup; the default device unless said\n"
                "  force_N_max=N  largest force; what libHD says unless said\n"
                "  library=PATH   of libHD.so\n"
                "  process=own    libHD's process: own, which ends a force when this one is\n"
                "                 killed, or same\n",
    .open = hd_open,
    .describe = hd_describe,
    .start = hd_start,
    .read = hd_read,
    .command = hd_command,
    .stop = hd_stop,
    .close = hd_close,
    .last_error = hd_last_error,
};

const forcebound_driver* forcebound_driver_entry(uint32_t wanted) {
  (void)wanted;
  return &kOpenHaptics;
}
