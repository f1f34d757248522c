/* Devices of Force Dimension (omega, delta, sigma, lambda) and the Novint Falcon, through Force Dimension's libdhd, which
 * is looked for when the device is opened.
 *
 * Interface: the functions of dhdc.h, Force Dimension SDK 3, as its documentation and public programs use them. libdhd
 * talks to the device while it is called, for up to a millisecond, so it has a thread of its own here:
 *
 *     transport's thread: dhdGetPosition -> readings mailbox -> tick
 *                         dhdSetForce    <- commands mailbox <- tick
 *
 * It sends zero force once no command has come for kHold_s, and looks for a device that is gone every half second. The
 * watchdog of the device itself, where it has one, ends the force when this process is killed or stopped.
 *
 * libdhd's frame has x towards the user, y to his right, z up; the scene's x is libdhd's y, its y libdhd's -x.
 *
 * Never tried on hardware: tested against a library with these functions and a simulated device behind them.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <forcebound/driver/forcebound_device.h>
#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "mailbox.h"
#include "pause.h"
#include "setting_number.h"

enum { kReadingNumbers = 6, kCommandNumbers = 4, kDhdTimeGuard = 1 };
/* 20 ms in the 125 us of dhdSetWatchdog, which not all devices have: twice as long as a force lasts here. */
static const unsigned char kWatchdog = 160;
static const double kWatchdogUnit_s = 125e-6;
static const double kHold_s = 0.01;
static const int kPriority = 79;
static const long kLookAgain_ns = 500000000;
static const long kPause_ns = 100000;

/* Of libdhd. The last argument is the device's number there. */
typedef struct dhd {
  void* library;
  int (*get_device_count)(void);
  int (*open_id)(char);
  int (*close)(char);
  int (*stop)(char);
  const char* (*get_system_name)(char);
  int (*enable_force)(unsigned char, char);
  int (*get_position)(double*, double*, double*, char);
  int (*set_force)(double, double, double, char);
  unsigned int (*get_button_mask)(char);
  const char* (*error_get_last_str)(void);
  int (*set_time_guard)(int, char);         /* may be missing */
  int (*set_watchdog)(unsigned char, char); /* likewise */
} dhd;

struct forcebound_device {
  dhd dhd;
  char number;       /* of the device, 0 for the first */
  char id;           /* of the open device at libdhd */
  double force_N_max;
  char name[FORCEBOUND_TEXT_BYTES];
  char error[FORCEBOUND_TEXT_BYTES];
  double sent_s;     /* when the last force was sent; the transport's */
  uint64_t taken;    /* readings that the tick has taken */
  mailbox readings;  /* latched [s], x, y, z, buttons, whether the device is there */
  mailbox commands;  /* at [s], x, y, z */
  int stopping;      /* atomic: the tick's side wants zero force, whatever was commanded */
  int ending;        /* atomic: the thread ends */
  int runs;
  pthread_t thread;
};

/* What is published of each kind: largest force, position resolution. All else is not known. */
typedef struct kind {
  const char* begins;
  double force_N_max;
  double step_m;
} kind;
static const kind kKinds[] = {{"falcon", 8, 6.4e-5}, {"omega", 12, 1e-5}, {"delta", 20, 3e-5},
                              {"sigma", 20, 1.5e-6}, {"lambda", 20, 1.5e-6}};
static const kind kAnyKind = {"", 5, 1e-4};

static kind kind_of(const char* name) {
  size_t i;
  const char* const last = strrchr(name, ' '); /* "Novint Falcon" */
  for (i = 0; i < sizeof kKinds / sizeof *kKinds; ++i) {
    const size_t length = strlen(kKinds[i].begins);
    if (strncasecmp(name, kKinds[i].begins, length) == 0) return kKinds[i];
    if (last != NULL && strncasecmp(last + 1, kKinds[i].begins, length) == 0) return kKinds[i];
  }
  return kAnyKind;
}

static int look_up(dhd* to, const char* path, char* error, size_t error_bytes) {
  const char* const usual[] = {"libdhd.so.3", "libdhd.so", NULL};
  const char* const given[] = {path, NULL};
  const char* const* file = path != NULL ? given : usual;
  for (; *file != NULL && to->library == NULL; ++file) to->library = dlopen(*file, RTLD_NOW | RTLD_LOCAL);
  if (to->library == NULL) {
    snprintf(error, error_bytes,
             "Force Dimension's library %s is not there: looked for %s where the system looks for libraries; it is in "
             "the SDK from forcedimension.com; accepted is also library=PATH",
             path != NULL ? path : "libdhd", path != NULL ? path : "libdhd.so.3 and libdhd.so");
    return 0;
  }
#define LOOK_UP(member, symbol)                                                         \
  do {                                                                                  \
    *(void**)&to->member = dlsym(to->library, symbol);                                  \
    if (to->member == NULL) {                                                           \
      snprintf(error, error_bytes, "the library that was found lacks the function %s of libdhd 3", symbol); \
      return 0;                                                                         \
    }                                                                                   \
  } while (0)
  LOOK_UP(get_device_count, "dhdGetDeviceCount");
  LOOK_UP(open_id, "dhdOpenID");
  LOOK_UP(close, "dhdClose");
  LOOK_UP(stop, "dhdStop");
  LOOK_UP(get_system_name, "dhdGetSystemName");
  LOOK_UP(enable_force, "dhdEnableForce");
  LOOK_UP(get_position, "dhdGetPosition");
  LOOK_UP(set_force, "dhdSetForce");
  LOOK_UP(get_button_mask, "dhdGetButtonMask");
  LOOK_UP(error_get_last_str, "dhdErrorGetLastStr");
#undef LOOK_UP
  *(void**)&to->set_time_guard = dlsym(to->library, "dhdSetTimeGuard");
  *(void**)&to->set_watchdog = dlsym(to->library, "dhdSetWatchdog");
  return 1;
}

static void give_up(forcebound_device* device) {
  if (device->dhd.library != NULL) dlclose(device->dhd.library);
  free(device);
}

static int open_at_library(forcebound_device* device) {
  const int id = device->dhd.open_id(device->number);
  if (id < 0) return 0;
  device->id = (char)id;
  /* Each call reads the device: an old reading must not pass for a new one. */
  if (device->dhd.set_time_guard != NULL) device->dhd.set_time_guard(0, device->id);
  return 1;
}

static int fd_open(const forcebound_setting* settings, size_t count, forcebound_device** opened, char* error,
                   size_t error_bytes) {
  const char* path = NULL;
  size_t i;
  forcebound_device* const device = calloc(1, sizeof *device);
  if (device == NULL) return FORCEBOUND_FAILED;
  for (i = 0; i < count; ++i) {
    const char* const key = settings[i].key;
    const char* const value = settings[i].value;
    double number = 0;
    const int is_number = setting_number(value, &number);
    if (strcmp(key, "library") == 0 && *value != '\0') {
      path = value;
    } else if (strcmp(key, "number") == 0 && is_number && number >= 0 && number < 16 && number == (int)number) {
      device->number = (char)number;
    } else if (strcmp(key, "force_N_max") == 0 && is_number && number > 0 && number <= 100) {
      device->force_N_max = number;
    } else {
      snprintf(error, error_bytes,
               "'%s=%s' is not accepted; accepted are number=0 to 15, force_N_max=N and library=PATH", key, value);
      give_up(device);
      return FORCEBOUND_FAILED;
    }
  }
  if (!look_up(&device->dhd, path, error, error_bytes)) {
    give_up(device);
    return FORCEBOUND_FAILED;
  }
  if (!open_at_library(device)) {
    const char* const why = device->dhd.error_get_last_str();
    snprintf(error, error_bytes, "no device number %d among the %d that libdhd finds on USB and PCI: %s", device->number,
             device->dhd.get_device_count(), why != NULL ? why : "no reason given");
    give_up(device);
    return FORCEBOUND_FAILED;
  }
  {
    const char* const name = device->dhd.get_system_name(device->id);
    snprintf(device->name, sizeof device->name, "%s", name != NULL ? name : "device of Force Dimension");
  }
  if (device->force_N_max == 0) device->force_N_max = kind_of(device->name).force_N_max;
  *opened = device;
  return FORCEBOUND_OK;
}

static int fd_describe(forcebound_device* device, forcebound_facts* facts) {
  const kind known = kind_of(device->name);
  int i;
  facts->degrees_of_freedom = 3;
  snprintf(facts->name, sizeof facts->name, "%s", device->name);
  facts->identified = 0; /* its maker publishes neither damping nor friction */
  facts->period_s = 1e-3;
  for (i = 0; i < 3; ++i) {
    facts->damping[4 * i] = 0.5;
    facts->encoder_step[i] = known.step_m;
  }
  facts->force_N_max = device->force_N_max;
  facts->hold_s_max = kHold_s;
  facts->latency_s = 1e-3;
  facts->stamp_s_most = 1e-3;
  return FORCEBOUND_OK;
}

/* Reads once. 0: the device is gone. */
static int read_once(forcebound_device* device) {
  double x = 0, y = 0, z = 0;
  const double before_s = now_s();
  const int result = device->dhd.get_position(&x, &y, &z, device->id);
  const double reading[kReadingNumbers] = {0.5 * (before_s + now_s()), y, -x, z,
                                           (double)device->dhd.get_button_mask(device->id), 1};
  if (result < 0) return 0;
  if (result != kDhdTimeGuard) mailbox_write(&device->readings, reading, kReadingNumbers);
  return 1;
}

/* Switches the force on. Below zero: it cannot be. */
static int enable(forcebound_device* device) {
  /* The device's own: it ends the force when this process is killed or stopped. */
  if (device->dhd.set_watchdog != NULL) device->dhd.set_watchdog(kWatchdog, device->id);
  /* Lest the force of before be back for a round: libdhd may have kept it. */
  (void)device->dhd.set_force(0, 0, 0, device->id);
  device->sent_s = now_s();
  if (device->dhd.enable_force(1, device->id) < 0) return -1;
  return device->dhd.set_force(0, 0, 0, device->id);
}

/* Sends the newest force, or none if it is too old. 0: the device is gone. */
static int command_once(forcebound_device* device) {
  double command[kCommandNumbers] = {0};
  /* Its watchdog has switched the force off, and may wait to be told to switch it on. */
  if (now_s() - device->sent_s > kWatchdogUnit_s * kWatchdog && enable(device) < 0) return 0;
  device->sent_s = now_s();
  const uint64_t there = mailbox_read(&device->commands, command, kCommandNumbers);
  const int holds = there > 0 && now_s() - command[0] <= kHold_s && !__atomic_load_n(&device->stopping, __ATOMIC_ACQUIRE);
  if (!holds) return device->dhd.set_force(0, 0, 0, device->id) >= 0;
  return device->dhd.set_force(-command[2], command[1], command[3], device->id) >= 0;
}

static void look_again(forcebound_device* device) {
  const double gone[kReadingNumbers] = {0};
  mailbox_write(&device->readings, gone, kReadingNumbers);
  device->dhd.close(device->id);
  while (!__atomic_load_n(&device->ending, __ATOMIC_ACQUIRE) && !open_at_library(device)) rest(kLookAgain_ns);
  (void)enable(device);
}

static void* transport(void* of) {
  forcebound_device* const device = of;
  const struct sched_param priority = {.sched_priority = kPriority};
  (void)pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority);
  while (!__atomic_load_n(&device->ending, __ATOMIC_ACQUIRE)) {
    if (!read_once(device) || !command_once(device)) look_again(device);
    rest(kPause_ns);
  }
  device->dhd.set_force(0, 0, 0, device->id);
  return NULL;
}

static int fd_start(forcebound_device* device) {
  if (device->runs) return FORCEBOUND_OK;
  if (enable(device) < 0) {
    const char* const why = device->dhd.error_get_last_str();
    snprintf(device->error, sizeof device->error, "forces cannot be switched on: %s", why != NULL ? why : "");
    return FORCEBOUND_FAILED;
  }
  if (pthread_create(&device->thread, NULL, transport, device) != 0) {
    snprintf(device->error, sizeof device->error, "no thread for the device");
    return FORCEBOUND_FAILED;
  }
  device->runs = 1;
  return FORCEBOUND_OK;
}

static int fd_read(forcebound_device* device, int64_t now_ns, forcebound_reading* reading) {
  double newest[kReadingNumbers];
  const uint64_t writes = mailbox_read(&device->readings, newest, kReadingNumbers);
  if (writes == 0 || writes == device->taken) return FORCEBOUND_STALE;
  if (newest[5] == 0) {
    snprintf(device->error, sizeof device->error, "%.200s does not answer; looking for it", device->name);
    return FORCEBOUND_UNPLUGGED;
  }
  device->taken = writes;
  reading->latched_ns = (int64_t)(1e9 * newest[0]);
  if (reading->latched_ns > now_ns) reading->latched_ns = now_ns; /* it came after the tick began */
  memcpy(reading->position_m, newest + 1, 3 * sizeof *newest);
  reading->has = FORCEBOUND_HAS_BUTTONS;
  reading->buttons = (uint32_t)newest[4];
  return FORCEBOUND_OK;
}

static int fd_command(forcebound_device* device, const forcebound_command* command) {
  const double numbers[kCommandNumbers] = {1e-9 * (double)command->at_ns, command->force_N[0], command->force_N[1],
                                           command->force_N[2]};
  mailbox_write(&device->commands, numbers, kCommandNumbers);
  __atomic_store_n(&device->stopping, 0, __ATOMIC_RELEASE);
  return FORCEBOUND_OK;
}

static void fd_stop(forcebound_device* device) { __atomic_store_n(&device->stopping, 1, __ATOMIC_RELEASE); }

static void fd_close(forcebound_device* device) {
  if (device->runs) {
    __atomic_store_n(&device->ending, 1, __ATOMIC_RELEASE);
    pthread_join(device->thread, NULL);
  }
  device->dhd.stop(device->id);
  device->dhd.close(device->id);
  give_up(device);
}

static const char* fd_last_error(forcebound_device* device) { return device->error; }

static const forcebound_driver kForceDimension = {
    .size = sizeof kForceDimension,
    .interface_version = FORCEBOUND_DEVICE_INTERFACE,
    .name = "force-dimension",
    .description = "omega, delta, sigma, lambda and the Novint Falcon, by Force Dimension's libdhd",
    .settings = "  number=N       which of several, from 0\n"
                "  force_N_max=N  largest force; what its maker publishes unless said\n"
                "  library=PATH   of libdhd\n",
    .open = fd_open,
    .describe = fd_describe,
    .start = fd_start,
    .read = fd_read,
    .command = fd_command,
    .stop = fd_stop,
    .close = fd_close,
    .last_error = fd_last_error,
};

const forcebound_driver* forcebound_driver_entry(uint32_t wanted) {
  (void)wanted;
  return &kForceDimension;
}
