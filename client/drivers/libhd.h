/* libHD, the library of OpenHaptics' HDAPI, as far as the driver uses it, looked up while the program runs.
 *
 * Types, numbers and functions are those of OpenHaptics 3.0 as include/HD/hdDefines.h of github.com/hhmai/PhantomAPI and
 * the programs that are public use them.
 */
#ifndef FORCEBOUND_DRIVERS_LIBHD_H
#define FORCEBOUND_DRIVERS_LIBHD_H

#include <dlfcn.h>
#include <stddef.h>
#include <stdio.h>

enum {
  kHdSuccess = 0x0000,
  kHdBadHandle = 0x0104,
  kHdFirstForceError = 0x0200, /* warm motors; too much force, impulse, velocity; another */
  kHdLastForceError = 0x0204,
  kHdFirstDeviceError = 0x0300, /* fault, initiated already, communication, its set-up, timer */
  kHdLastDeviceError = 0x0304,
  kHdButtons = 0x2000,
  kHdPosition = 0x2050,
  kHdTransform = 0x2052,
  kHdModel = 0x2501,
  kHdSerialNumber = 0x2504,
  kHdCalibrationStyle = 0x2555,
  kHdForceMost = 0x2603,
  kHdForceContinuous = 0x2604, /* that it may give for long */
  kHdForce = 0x2700,
  kHdForceOutput = 0x4000,
  kHdCalibrationNeedsUpdate = 0x5001,
  kHdCalibrationNeedsHand = 0x5002,
  kHdPriorityMost = 0xFFFF,
  kHdErrorsMost = 32, /* of our own: on libHD's stack of errors */
  kHdDone = 0,
  kHdContinue = 1
};
#define HD_NO_HANDLE 0xFFFFFFFFu
#define HD_TRANSFORM_NUMBERS 16

typedef struct hd_error {
  unsigned int code;
  int internal_code;
  unsigned int handle;
} hd_error;
typedef unsigned int (*hd_callback)(void*);

typedef struct hd {
  void* library;
  unsigned int (*init_device)(const char*);
  void (*disable_device)(unsigned int);
  void (*make_current_device)(unsigned int);
  void (*enable)(unsigned int);
  void (*begin_frame)(unsigned int);
  void (*end_frame)(unsigned int);
  void (*get_double)(unsigned int, double*);
  void (*set_double)(unsigned int, const double*);
  void (*get_integer)(unsigned int, int*);
  const char* (*get_string)(unsigned int);
  hd_error (*get_error)(void);
  const char* (*get_error_string)(unsigned int);
  unsigned int (*check_calibration)(void);
  void (*update_calibration)(unsigned int);
  void (*start_scheduler)(void);
  void (*stop_scheduler)(void);
  unsigned long (*schedule)(hd_callback, void*, unsigned short);
  void (*unschedule)(unsigned long);
} hd;

/* 0: there is no such library, or not with all of these; `error` says it in a line. */
static inline int hd_look_up(hd* to, const char* path, char* error, size_t error_bytes) {
  size_t i;
  to->library = dlopen(path != NULL ? path : "libHD.so", RTLD_NOW | RTLD_LOCAL);
  if (to->library == NULL) {
    const char* const why = dlerror();
    snprintf(error, error_bytes,
             "no library of OpenHaptics: %.120s; libHD.so is in OpenHaptics for Linux from 3dsystems.com, and may be "
             "anywhere with library=PATH",
             why != NULL ? why : "libHD.so");
    return 0;
  }
  {
    const struct {
      void** function;
      const char* name;
    } wanted[] = {{(void**)&to->init_device, "hdInitDevice"},
                  {(void**)&to->disable_device, "hdDisableDevice"},
                  {(void**)&to->make_current_device, "hdMakeCurrentDevice"},
                  {(void**)&to->enable, "hdEnable"},
                  {(void**)&to->begin_frame, "hdBeginFrame"},
                  {(void**)&to->end_frame, "hdEndFrame"},
                  {(void**)&to->get_double, "hdGetDoublev"},
                  {(void**)&to->set_double, "hdSetDoublev"},
                  {(void**)&to->get_integer, "hdGetIntegerv"},
                  {(void**)&to->get_string, "hdGetString"},
                  {(void**)&to->get_error, "hdGetError"},
                  {(void**)&to->get_error_string, "hdGetErrorString"},
                  {(void**)&to->check_calibration, "hdCheckCalibration"},
                  {(void**)&to->update_calibration, "hdUpdateCalibration"},
                  {(void**)&to->start_scheduler, "hdStartScheduler"},
                  {(void**)&to->stop_scheduler, "hdStopScheduler"},
                  {(void**)&to->schedule, "hdScheduleAsynchronous"},
                  {(void**)&to->unschedule, "hdUnschedule"}};
    for (i = 0; i < sizeof wanted / sizeof *wanted; ++i) {
      *wanted[i].function = dlsym(to->library, wanted[i].name);
      if (*wanted[i].function != NULL) continue;
      snprintf(error, error_bytes, "the library that was found lacks the function %s of OpenHaptics 3", wanted[i].name);
      return 0;
    }
  }
  return 1;
}

static inline const char* hd_in_words(const hd* hd, unsigned int code) {
  const char* const text = hd->get_error_string(code);
  return text != NULL && *text != '\0' ? text : "no reason given";
}

/* The first error since the last call, which libHD gives last. */
static inline unsigned int hd_first_error(const hd* hd) {
  unsigned int code = kHdSuccess;
  int i;
  for (i = 0; i < kHdErrorsMost; ++i) {
    const hd_error error = hd->get_error();
    if (error.code == kHdSuccess) break;
    code = error.code;
  }
  return code;
}

static inline int hd_means_lost(unsigned int code) {
  return code == kHdBadHandle || (code >= kHdFirstDeviceError && code <= kHdLastDeviceError);
}

static inline int hd_means_no_force(unsigned int code) { return code >= kHdFirstForceError && code <= kHdLastForceError; }

/* Of an error that means no force; known without the library, which another process may have. */
static inline const char* hd_force_error_in_words(unsigned int code) {
  static const char* const kWords[] = {"warm motors", "force above the largest", "force changed too fast",
                                       "velocity above the largest", "error of force"};
  return kWords[code - kHdFirstForceError];
}

#endif
