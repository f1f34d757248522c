/* The half of the OpenHaptics driver that talks to libHD, which may run in a process of its own.
 *
 * libHD has a thread, the scheduler, at 1 kHz. It calls us once in each round:
 *
 *     scheduler: hdBeginFrame, HD_CURRENT_POSITION -> readings queue   -> tick
 *                HD_CURRENT_FORCE, hdEndFrame      <- commands mailbox <- tick
 *
 * The force is zero once no command has come for kHold_s. A thread of ours, the keeper, looks every half second for a
 * device that is gone: whose errors say so, or for which the scheduler has not called for kSilent_s.
 *
 * A calibration that libHD wants to update may move the position at once. It is updated only after a round without
 * force, and for kSettle_s after that there is neither a force nor a reading: long enough for the client to take the
 * device for gone, forget where it was, and let the force grow again.
 */
#ifndef FORCEBOUND_DRIVERS_OPENHAPTICS_ROUNDS_H
#define FORCEBOUND_DRIVERS_OPENHAPTICS_ROUNDS_H

#include <forcebound/driver/forcebound_device.h>
#include <pthread.h>
#include <string.h>

#include "libhd.h"
#include "mailbox.h"
#include "own_process.h"
#include "pause.h"
#include "quaternion.h"

/* What the scheduler tells the tick, in the scene's frame. */
enum { kLatched, kX, kY, kZ, kButtons, kFault, kQuaternion, kReadingNumbers = kQuaternion + 4 };
/* What the tick tells the scheduler. */
enum { kAt, kForceX, kForceY, kForceZ, kCommandNumbers };

static const double kHold_s = 0.01;
static const double kSettle_s = 0.03; /* the client takes a device for gone after 0.02 s */
static const double kSilent_s = 0.5;
static const long kLookAgain_ns = 500000000;
static const long kLookWhether_ns = 20000000;
static const long kRound_ns = 1000000;

/* In memory that both processes have. */
struct forcebound_device {
  hd hd; /* of the half that talks to libHD */
  own_process process;
  char library[1024]; /* empty: as the system finds it */
  char wanted[FORCEBOUND_TEXT_BYTES]; /* name in libHD's configuration; empty: its default device */
  unsigned int handle;
  unsigned long operation; /* our callback at the scheduler */
  unsigned int calibration_style;
  double force_N_max;
  double force_N_continuous;
  char name[FORCEBOUND_TEXT_BYTES];
  char error[FORCEBOUND_TEXT_BYTES];
  double settles_s;  /* until then there is no force after a new calibration; the scheduler's */
  int released;      /* the last round was without force; the scheduler's */
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

static inline int is_set(const int* flag) { return __atomic_load_n(flag, __ATOMIC_ACQUIRE); }
static inline void set(int* flag, int value) { __atomic_store_n(flag, value, __ATOMIC_RELEASE); }

static inline void disable(forcebound_device* device) {
  if (device->handle != HD_NO_HANDLE) device->hd.disable_device(device->handle);
  device->handle = HD_NO_HANDLE;
  (void)hd_first_error(&device->hd);
}

static inline unsigned int open_at_library(forcebound_device* device) {
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

/* The handle's axes in the scene, from a transform of libHD. */
static inline void scene_orientation(const double* transform, double q[4]) {
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
static inline void wanted_force(forcebound_device* device, double* force_N) {
  double command[kCommandNumbers] = {0};
  const uint64_t there = mailbox_read(&device->commands, command, kCommandNumbers);
  const int holds = there > 0 && now_s() - command[kAt] <= kHold_s;
  memset(force_N, 0, 3 * sizeof *force_N);
  if (!holds || is_set(&device->stopping) || is_set(&device->ending)) return;
  force_N[0] = command[kForceX];
  force_N[1] = command[kForceZ];
  force_N[2] = -command[kForceY];
}

/* Why there is no force in this round, as a code of libHD's calibration; 0: there may be one. */
static inline unsigned int calibrate(forcebound_device* device) {
  const unsigned int calibration = device->hd.check_calibration();
  if (calibration == kHdCalibrationNeedsHand) return calibration;
  if (calibration == kHdCalibrationNeedsUpdate) {
    if (!device->released) return calibration;
    device->hd.update_calibration(device->calibration_style);
    device->settles_s = now_s() + kSettle_s;
  }
  return now_s() < device->settles_s ? kHdCalibrationNeedsUpdate : 0;
}

/* One round of the scheduler, on its thread. */
static inline unsigned int round_of(void* of) {
  forcebound_device* const device = of;
  const hd* const hd = &device->hd;
  const int ends = is_set(&device->ending);
  unsigned int calibration;
  double position_mm[3] = {0};
  double transform[HD_TRANSFORM_NUMBERS] = {0};
  double force_N[3] = {0};
  double reading[kReadingNumbers] = {0};
  int buttons = 0;
  unsigned int code;
  double before_s;
  if (__atomic_load_n(&device->lost, __ATOMIC_ACQUIRE) != kHdSuccess) return kHdDone;
  hd->make_current_device(device->handle);
  calibration = calibrate(device);
  before_s = now_s();
  hd->begin_frame(device->handle);
  reading[kLatched] = 0.5 * (before_s + now_s());
  hd->get_double(kHdPosition, position_mm);
  hd->get_double(kHdTransform, transform);
  hd->get_integer(kHdButtons, &buttons);
  if (calibration == 0) wanted_force(device, force_N);
  hd->set_double(kHdForce, force_N);
  hd->end_frame(device->handle);
  device->released = calibration != 0;
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
  if (calibration == kHdCalibrationNeedsUpdate) __atomic_store_n(&device->fault, calibration, __ATOMIC_RELEASE);
  reading[kFault] = calibration;
  scene_orientation(transform, reading + kQuaternion);
  mailbox_queue_write(&device->readings, reading, kReadingNumbers);
  if (ends) set(&device->ended, 1);
  return ends ? kHdDone : kHdContinue;
}

/* Switches the force on and has the scheduler call us. */
static inline unsigned int begin_rounds(forcebound_device* device) {
  unsigned int code;
  device->hd.make_current_device(device->handle);
  device->hd.enable(kHdForceOutput);
  device->operation = device->hd.schedule(round_of, device, kHdPriorityMost);
  device->hd.start_scheduler();
  code = hd_first_error(&device->hd);
  return code;
}

static inline void end_rounds(forcebound_device* device) {
  device->hd.stop_scheduler();
  device->hd.unschedule(device->operation);
  disable(device);
}

static inline void look_again(forcebound_device* device) {
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

static inline void* keep(void* of) {
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

#endif
