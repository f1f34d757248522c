/* Touch, Touch X and Phantom devices, through the HDAPI of OpenHaptics, libHD, which is looked for when the device is
 * opened.
 *
 * Order of calls, axes, calibration and which errors end the scheduling as in omni_common/src/omni_state.cpp of
 * github.com/bharatm11/Geomagic_Touch_ROS_Drivers; the interface is in libhd.h.
 *
 * libHD has a thread of its own, the scheduler, at 1 kHz. It calls us once in each round:
 *
 *     scheduler: hdBeginFrame, HD_CURRENT_POSITION -> readings queue   -> tick
 *                HD_CURRENT_FORCE, hdEndFrame      <- commands mailbox <- tick
 *
 * The force is zero once no command has come for kHold_s. A thread of ours, the keeper, looks every half second for a
 * device that is gone: whose errors say so, or for which the scheduler has not called for kSilent_s.
 *
 * libHD's frame has x to the user's right, y up, z towards him, in millimetres; the scene's y is libHD's -z, its z
 * libHD's y. The columns of a transform follow one another.
 *
 * Never tried on hardware: tested against a library with these functions and a simulated device behind them.
 */
#define _GNU_SOURCE
#include <forcebound/driver/forcebound_device.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "libhd.h"
#include "mailbox.h"
#include "pause.h"
#include "quaternion.h"

/* What the scheduler tells the tick, in the scene's frame. */
enum { kLatched, kX, kY, kZ, kButtons, kFault, kQuaternion, kReadingNumbers = kQuaternion + 4 };
/* What the tick tells the scheduler. */
enum { kAt, kForceX, kForceY, kForceZ, kCommandNumbers };

static const int kLastRoundsMost = 100;
static const double kHold_s = 0.01;
static const double kSilent_s = 0.5;
static const long kLookAgain_ns = 500000000;
static const long kLookWhether_ns = 20000000;
static const long kRound_ns = 1000000;

struct forcebound_device {
  hd hd;
  char wanted[FORCEBOUND_TEXT_BYTES]; /* name in libHD's configuration; empty: its default device */
  unsigned int handle;
  unsigned long operation; /* our callback at the scheduler */
  unsigned int calibration_style;
  double force_N_max;
  char name[FORCEBOUND_TEXT_BYTES];
  char error[FORCEBOUND_TEXT_BYTES];
  mailbox_queue readings;
  mailbox commands;
  uint64_t rounds;   /* atomic: that the scheduler has called */
  unsigned int fault; /* atomic: newest reason for no force that read has not told; 0: none */
  unsigned int lost; /* atomic: the device is gone, by this error of libHD */
  int stopping;      /* atomic: the tick's side wants zero force, whatever was commanded */
  int ending;        /* atomic: one round with zero force, then no more */
  int ended;         /* atomic: that round was */
  int runs;
  pthread_t keeper;
};

/* Distance of two neighbouring readings as published, of models whose name has this in it, the longer names first. */
typedef struct model {
  const char* has;
  double step_m;
} model;
static const model kModels[] = {{"Touch X", 2.3e-5}, {"Touch", 5.5e-5},   {"Omni", 5.5e-5},
                                {"Desktop", 2.3e-5}, {"Premium", 3e-5}};
static const double kStep_m = 1e-4;

static int is_set(const int* flag) { return __atomic_load_n(flag, __ATOMIC_ACQUIRE); }
static void set(int* flag, int value) { __atomic_store_n(flag, value, __ATOMIC_RELEASE); }

static void disable(forcebound_device* device) {
  if (device->handle != HD_NO_HANDLE) device->hd.disable_device(device->handle);
  device->handle = HD_NO_HANDLE;
  (void)hd_first_error(&device->hd);
}

static unsigned int open_at_library(forcebound_device* device) {
  unsigned int code;
  int styles = 0;
  (void)hd_first_error(&device->hd);
  device->handle = device->hd.init_device(device->wanted[0] != '\0' ? device->wanted : NULL);
  code = hd_first_error(&device->hd);
  if (device->handle == HD_NO_HANDLE) return code != kHdSuccess ? code : kHdBadHandle;
  if (code != kHdSuccess) {
    disable(device);
    return code;
  }
  device->hd.get_integer(kHdCalibrationStyle, &styles);
  /* By itself if it can, else in the inkwell, else by resetting the encoders. */
  device->calibration_style = (styles & 2) != 0 ? 2 : (styles & 4) != 0 ? 4 : 1;
  (void)hd_first_error(&device->hd);
  return kHdSuccess;
}

static void give_up(forcebound_device* device) {
  if (device->hd.library != NULL) dlclose(device->hd.library);
  free(device);
}

/* 0: a setting is not accepted. */
static int take_settings(forcebound_device* device, const forcebound_setting* settings, size_t count, const char** path,
                         char* error, size_t error_bytes) {
  size_t i;
  for (i = 0; i < count; ++i) {
    const char* const key = settings[i].key;
    const char* const value = settings[i].value;
    char* end = NULL;
    const double number = strtod(value, &end);
    if (strcmp(key, "library") == 0 && *value != '\0') {
      *path = value;
    } else if (strcmp(key, "name") == 0 && *value != '\0' && strlen(value) < sizeof device->wanted) {
      strcpy(device->wanted, value);
    } else if (strcmp(key, "force_N_max") == 0 && end != value && *end == '\0' && number > 0 && number <= 100) {
      device->force_N_max = number;
    } else {
      snprintf(error, error_bytes,
               "'%s=%s' is not accepted; accepted are name=NAME, force_N_max=N up to 100 and library=PATH", key, value);
      return 0;
    }
  }
  return 1;
}

static int hd_open(const forcebound_setting* settings, size_t count, forcebound_device** opened, char* error,
                   size_t error_bytes) {
  const char* path = NULL;
  const char* model = NULL;
  const char* serial = NULL;
  unsigned int code;
  forcebound_device* const device = calloc(1, sizeof *device);
  if (device == NULL) return FORCEBOUND_FAILED;
  if (!take_settings(device, settings, count, &path, error, error_bytes) ||
      !hd_look_up(&device->hd, path, error, error_bytes)) {
    give_up(device);
    return FORCEBOUND_FAILED;
  }
  code = open_at_library(device);
  if (code != kHdSuccess) {
    snprintf(error, error_bytes,
             "libHD finds no device '%s': %s (0x%04x); devices get their names in 3D Systems' Touch Setup",
             device->wanted[0] != '\0' ? device->wanted : "Default Device", hd_in_words(&device->hd, code), code);
    give_up(device);
    return FORCEBOUND_FAILED;
  }
  model = device->hd.get_string(kHdModel);
  serial = device->hd.get_string(kHdSerialNumber);
  snprintf(device->name, sizeof device->name, "%.100s%s%.100s", model != NULL ? model : "device of OpenHaptics",
           serial != NULL && *serial != '\0' ? " " : "", serial != NULL ? serial : "");
  if (device->force_N_max == 0) device->hd.get_double(kHdForceMost, &device->force_N_max);
  (void)hd_first_error(&device->hd);
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
  return FORCEBOUND_OK;
}

/* The handle's axes in the scene, from a transform of libHD. */
static void scene_orientation(const double* transform, double q[4]) {
  double rows[3][3];
  int column;
  for (column = 0; column < 3; ++column) {
    rows[0][column] = transform[4 * column];
    rows[1][column] = -transform[4 * column + 2];
    rows[2][column] = transform[4 * column + 1];
  }
  to_quaternion(rows, q);
}

/* The newest force in libHD's frame, or none if it is too old. */
static void wanted_force(forcebound_device* device, int calibrated, double* force_N) {
  double command[kCommandNumbers] = {0};
  const uint64_t there = mailbox_read(&device->commands, command, kCommandNumbers);
  const int holds = there > 0 && now_s() - command[kAt] <= kHold_s;
  memset(force_N, 0, 3 * sizeof *force_N);
  if (!holds || !calibrated || is_set(&device->stopping) || is_set(&device->ending)) return;
  force_N[0] = command[kForceX];
  force_N[1] = command[kForceZ];
  force_N[2] = -command[kForceY];
}

/* One round of the scheduler, on its thread. */
static unsigned int round_of(void* of) {
  forcebound_device* const device = of;
  const hd* const hd = &device->hd;
  const int ends = is_set(&device->ending);
  unsigned int calibration;
  double position_mm[3] = {0};
  double transform[HD_TRANSFORM_NUMBERS] = {0};
  double force_N[3];
  double reading[kReadingNumbers] = {0};
  int buttons = 0;
  unsigned int code;
  double before_s;
  if (__atomic_load_n(&device->lost, __ATOMIC_ACQUIRE) != kHdSuccess) return kHdDone;
  hd->make_current_device(device->handle);
  calibration = hd->check_calibration();
  if (calibration == kHdCalibrationNeedsUpdate) hd->update_calibration(device->calibration_style);
  before_s = now_s();
  hd->begin_frame(device->handle);
  reading[kLatched] = 0.5 * (before_s + now_s());
  hd->get_double(kHdPosition, position_mm);
  hd->get_double(kHdTransform, transform);
  hd->get_integer(kHdButtons, &buttons);
  wanted_force(device, calibration != kHdCalibrationNeedsHand, force_N);
  hd->set_double(kHdForce, force_N);
  hd->end_frame(device->handle);
  code = hd_first_error(hd);
  __atomic_add_fetch(&device->rounds, 1, __ATOMIC_RELEASE);
  if (hd_means_lost(code)) {
    __atomic_store_n(&device->lost, code, __ATOMIC_RELEASE);
    return kHdDone;
  }
  reading[kX] = 1e-3 * position_mm[0];
  reading[kY] = -1e-3 * position_mm[2];
  reading[kZ] = 1e-3 * position_mm[1];
  reading[kButtons] = buttons;
  if (hd_means_no_force(code)) __atomic_store_n(&device->fault, code, __ATOMIC_RELEASE);
  reading[kFault] = calibration == kHdCalibrationNeedsHand ? calibration : 0;
  scene_orientation(transform, reading + kQuaternion);
  mailbox_queue_write(&device->readings, reading, kReadingNumbers);
  if (ends) set(&device->ended, 1);
  return ends ? kHdDone : kHdContinue;
}

/* Switches the force on and has the scheduler call us. */
static unsigned int begin_rounds(forcebound_device* device) {
  unsigned int code;
  device->hd.make_current_device(device->handle);
  device->hd.enable(kHdForceOutput);
  device->operation = device->hd.schedule(round_of, device, kHdPriorityMost);
  device->hd.start_scheduler();
  code = hd_first_error(&device->hd);
  return code;
}

static void end_rounds(forcebound_device* device) {
  device->hd.stop_scheduler();
  device->hd.unschedule(device->operation);
  disable(device);
}

static void look_again(forcebound_device* device) {
  end_rounds(device);
  while (!is_set(&device->ending)) {
    if (open_at_library(device) == kHdSuccess) {
      __atomic_store_n(&device->lost, kHdSuccess, __ATOMIC_RELEASE);
      if (begin_rounds(device) == kHdSuccess) return;
      __atomic_store_n(&device->lost, kHdFirstDeviceError, __ATOMIC_RELEASE);
      end_rounds(device);
    }
    rest(kLookAgain_ns);
  }
}

static void* keep(void* of) {
  forcebound_device* const device = of;
  uint64_t rounds = 0;
  double heard_s = now_s();
  while (!is_set(&device->ending)) {
    const uint64_t rounds_now = __atomic_load_n(&device->rounds, __ATOMIC_ACQUIRE);
    if (rounds_now != rounds) heard_s = now_s();
    rounds = rounds_now;
    if (now_s() - heard_s > kSilent_s) {
      __atomic_store_n(&device->lost, kHdFirstDeviceError, __ATOMIC_RELEASE);
    }
    if (__atomic_load_n(&device->lost, __ATOMIC_ACQUIRE) != kHdSuccess) {
      look_again(device);
      heard_s = now_s();
    }
    rest(kLookWhether_ns);
  }
  return NULL;
}

static int hd_start(forcebound_device* device) {
  unsigned int code;
  if (device->runs) return FORCEBOUND_OK;
  code = begin_rounds(device);
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

static int hd_read(forcebound_device* device, int64_t now_ns, forcebound_reading* reading) {
  double newest[kReadingNumbers];
  const unsigned int lost = __atomic_load_n(&device->lost, __ATOMIC_ACQUIRE);
  unsigned int fault;
  (void)now_ns;
  if (lost != kHdSuccess) {
    mailbox_queue_forget(&device->readings);
    snprintf(device->error, sizeof device->error, "%.150s does not answer (libHD's error 0x%04x); looking for it",
             device->name, lost);
    return FORCEBOUND_UNPLUGGED;
  }
  /* Not with the readings, of which a slow tick misses some. */
  fault = __atomic_exchange_n(&device->fault, 0, __ATOMIC_ACQ_REL);
  if (fault != 0) {
    snprintf(device->error, sizeof device->error, "%.100s gives no force: %.80s (0x%04x)", device->name,
             hd_in_words(&device->hd, fault), fault);
    return FORCEBOUND_FAILED;
  }
  if (!mailbox_queue_read(&device->readings, newest, kReadingNumbers)) return FORCEBOUND_STALE;
  if (newest[kFault] == kHdCalibrationNeedsHand) {
    snprintf(device->error, sizeof device->error, "%.150s must be calibrated: put its stylus into the inkwell",
             device->name);
    return FORCEBOUND_FAILED;
  }
  reading->latched_ns = (int64_t)(1e9 * newest[kLatched]);
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

static void hd_close(forcebound_device* device) {
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
  disable(device);
  give_up(device);
}

static const char* hd_last_error(forcebound_device* device) { return device->error; }

static const forcebound_driver kOpenHaptics = {
    .size = sizeof kOpenHaptics,
    .interface_version = FORCEBOUND_DEVICE_INTERFACE,
    .name = "openhaptics",
    .description = "Touch, Touch X and Phantom, by OpenHaptics' libHD",
    .settings = "  name=NAME      as in Touch Setup; the default device unless said\n"
                "  force_N_max=N  largest force; what libHD says unless said\n"
                "  library=PATH   of libHD.so\n",
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
