/* Mice, tablets, gamepads and 3D mice as devices without motors, through Linux' input devices and libevdev.
 *
 * The tick reads events itself, since that never waits. A keeper's thread looks for a device that is gone every half
 * second; while it does, the tick leaves the device alone.
 *
 * Without motors there is no force. The law runs as on a device of the damping and largest force in the settings, and
 * the client shows what it would apply.
 */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <forcebound/driver/forcebound_device.h>
#include <libevdev/libevdev.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "evdev_events.h"
#include "pause.h"
#include "setting_number.h"

enum { kDevicesMost = 64, kPathBytes = 512 };
static const char kFolder[] = "/dev/input";
static const long kLookAgain_ns = 500000000;
static const long kLookWhether_ns = 20000000;
static const double kHold_s = 0.01;

struct forcebound_device {
  struct libevdev* events; /* the keeper's while `gone` is set, else the tick's */
  int descriptor;
  char path[kPathBytes]; /* empty: the first that suits */
  char name[FORCEBOUND_TEXT_BYTES];
  char error[FORCEBOUND_TEXT_BYTES];
  double damping_N_s_per_m;
  double force_N_max;
  evdev_state state;
  int gone;   /* atomic */
  int ending; /* atomic */
  int runs;
  pthread_t keeper;
};

static int is_set(const int* flag) { return __atomic_load_n(flag, __ATOMIC_ACQUIRE); }
static void set(int* flag, int to) { __atomic_store_n(flag, to, __ATOMIC_RELEASE); }

/* Why a device has no point to give; NULL: it has. */
static const char* why_not(const struct libevdev* events) {
  const int relative = libevdev_has_event_code(events, EV_REL, REL_X) && libevdev_has_event_code(events, EV_REL, REL_Y);
  const int absolute = libevdev_has_event_code(events, EV_ABS, ABS_X) && libevdev_has_event_code(events, EV_ABS, ABS_Y);
  if (libevdev_has_property(events, INPUT_PROP_ACCELEROMETER)) return "a motion sensor";
  return relative || absolute ? NULL : "without x and y";
}

static void close_events(forcebound_device* device) {
  if (device->events != NULL) libevdev_free(device->events);
  if (device->descriptor >= 0) close(device->descriptor);
  device->events = NULL;
  device->descriptor = -1;
}

/* What was found and does not suit, for the error. */
typedef struct found {
  char text[FORCEBOUND_TEXT_BYTES];
  int count;
} found;

static void add_found(found* found, const char* path, const char* name, const char* why) {
  const size_t length = strlen(found->text);
  snprintf(found->text + length, sizeof found->text - length, "%s%s%s%.30s%s: %s", found->count > 0 ? ", " : "", path,
           name != NULL ? " (" : "", name != NULL ? name : "", name != NULL ? ")" : "", why);
  ++found->count;
}

/* 0: not opened; `found` says why. */
static int open_path(forcebound_device* device, const char* path, found* found) {
  const char* why = "not an input device";
  device->descriptor = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (device->descriptor < 0) {
    add_found(found, path, NULL, strerror(errno));
    return 0;
  }
  if (libevdev_new_from_fd(device->descriptor, &device->events) < 0) {
    device->events = NULL;
  } else {
    why = why_not(device->events);
    if (why == NULL) return 1;
  }
  add_found(found, path, device->events != NULL ? libevdev_get_name(device->events) : NULL, why);
  close_events(device);
  return 0;
}

static int is_event_file(const struct dirent* entry) { return strncmp(entry->d_name, "event", 5) == 0; }

/* 0: there is none; `found` says what there is. */
static int open_first(forcebound_device* device, found* found) {
  struct dirent** entries = NULL;
  const int count = scandir(kFolder, &entries, is_event_file, versionsort);
  int opened = 0;
  int i;
  if (count < 0) add_found(found, kFolder, NULL, strerror(errno));
  for (i = 0; i < count; ++i) {
    char path[kPathBytes];
    snprintf(path, sizeof path, "%s/%.64s", kFolder, entries[i]->d_name);
    free(entries[i]);
    if (opened || i >= kDevicesMost) continue;
    opened = open_path(device, path, found);
    /* Once it is unplugged no other one takes its place. */
    if (opened) memcpy(device->path, path, sizeof path);
  }
  free(entries);
  return opened;
}

static int open_any(forcebound_device* device, found* found) {
  return device->path[0] == '\0' ? open_first(device, found) : open_path(device, device->path, found);
}

/* Takes a setting that is a number from 0 to `most`, and not zero unless it may be. */
static int read_number(const forcebound_setting* setting, const char* key, double most, int may_be_zero,
                       double* number) {
  double value = 0;
  if (strcmp(setting->key, key) != 0 || !setting_number(setting->value, &value)) return 0;
  if (!(value >= 0 && value <= most) || (value == 0 && !may_be_zero)) return 0;
  *number = value;
  return 1;
}

static int apply_setting(forcebound_device* device, const forcebound_setting* setting) {
  evdev_scale* const scale = &device->state.scale;
  if (strcmp(setting->key, "path") == 0 && strlen(setting->value) - 1 < sizeof device->path - 1) {
    snprintf(device->path, sizeof device->path, "%s", setting->value);
    return 1;
  }
  if (strcmp(setting->key, "plane") == 0 && (strcmp(setting->value, "xy") == 0 || strcmp(setting->value, "xz") == 0)) {
    scale->upright = setting->value[1] == 'z';
    return 1;
  }
  return read_number(setting, "count_m", 0.1, 0, &scale->count_m) ||
         read_number(setting, "wheel_m", 0.1, 0, &scale->wheel_m) ||
         read_number(setting, "width_m", 10, 0, &scale->width_m) ||
         read_number(setting, "follow_s", 1, 1, &scale->follow_s) ||
         read_number(setting, "damping_N_s_per_m", 1000, 0, &device->damping_N_s_per_m) ||
         read_number(setting, "force_N_max", 100, 0, &device->force_N_max);
}

static int ev_open(const forcebound_setting* settings, size_t count, forcebound_device** opened, char* error,
                   size_t error_bytes) {
  found found = {{0}, 0};
  size_t i;
  forcebound_device* const device = calloc(1, sizeof *device);
  if (device == NULL) return FORCEBOUND_FAILED;
  device->descriptor = -1;
  device->damping_N_s_per_m = 5;
  device->force_N_max = 10;
  device->state.scale = (evdev_scale){.count_m = 1e-4, .wheel_m = 5e-3, .width_m = 0.2, .follow_s = 0.01};
  for (i = 0; i < count; ++i) {
    if (apply_setting(device, &settings[i])) continue;
    snprintf(error, error_bytes,
             "'%.40s=%.60s' is not accepted; accepted are path=FILE, plane=xy or xz, and as numbers count_m, wheel_m, "
             "width_m, follow_s, damping_N_s_per_m and force_N_max",
             settings[i].key, settings[i].value);
    free(device);
    return FORCEBOUND_FAILED;
  }
  if (!open_any(device, &found)) {
    snprintf(error, error_bytes, "no mouse, tablet, gamepad or 3D mouse: %.150s; path=FILE names one",
             found.count > 0 ? found.text : "there is no /dev/input/event*");
    free(device);
    return FORCEBOUND_FAILED;
  }
  evdev_begin(&device->state, device->events);
  {
    const char* const name = libevdev_get_name(device->events);
    snprintf(device->name, sizeof device->name, "%.150s (no motors)", name != NULL ? name : "input device");
  }
  *opened = device;
  return FORCEBOUND_OK;
}

static int ev_describe(forcebound_device* device, forcebound_facts* facts) {
  const evdev_scale* const scale = &device->state.scale;
  int i;
  facts->degrees_of_freedom = EVDEV_AXES;
  snprintf(facts->name, sizeof facts->name, "%s", device->name);
  facts->identified = 0; /* of a device with motors that there is not */
  facts->period_s = 1e-3;
  for (i = 0; i < EVDEV_AXES; ++i) {
    const evdev_range range = device->state.ranges[i];
    const double steps = (double)range.maximum - range.minimum;
    facts->damping[4 * i] = device->damping_N_s_per_m;
    facts->encoder_step[i] = !device->state.absolute || steps <= 0 ? scale->count_m : scale->width_m / steps;
    if (device->state.deflects) facts->encoder_step[i] = 0.5 * scale->width_m / EVDEV_DEFLECTION;
  }
  facts->force_N_max = device->force_N_max;
  facts->hold_s_max = kHold_s;
  return FORCEBOUND_OK;
}

static void* keep(void* of) {
  forcebound_device* const device = of;
  while (!is_set(&device->ending)) {
    if (is_set(&device->gone)) {
      found ignored = {{0}, 0};
      close_events(device);
      if (open_any(device, &ignored)) {
        evdev_begin(&device->state, device->events);
        set(&device->gone, 0);
      } else {
        rest(kLookAgain_ns);
      }
    }
    rest(kLookWhether_ns);
  }
  return NULL;
}

static int ev_start(forcebound_device* device) {
  if (device->runs) return FORCEBOUND_OK;
  if (pthread_create(&device->keeper, NULL, keep, device) != 0) {
    snprintf(device->error, sizeof device->error, "no thread for the device");
    return FORCEBOUND_FAILED;
  }
  device->runs = 1;
  return FORCEBOUND_OK;
}

static int ev_read(forcebound_device* device, int64_t now_ns, forcebound_reading* reading) {
  if (!is_set(&device->gone) && !evdev_take(&device->state, libevdev_next_event, device->events)) set(&device->gone, 1);
  if (is_set(&device->gone)) {
    snprintf(device->error, sizeof device->error, "%.150s is unplugged; looking for it", device->name);
    return FORCEBOUND_UNPLUGGED;
  }
  evdev_follow(&device->state, now_ns);
  reading->latched_ns = now_ns; /* it says nothing while it rests, and then it is where it was */
  memcpy(reading->position_m, device->state.point_m, sizeof device->state.point_m);
  reading->has = FORCEBOUND_HAS_BUTTONS;
  reading->buttons = device->state.buttons;
  return FORCEBOUND_OK;
}

static int ev_command(forcebound_device* device, const forcebound_command* command) {
  (void)device;
  (void)command;
  return FORCEBOUND_OK;
}

static void ev_stop(forcebound_device* device) { (void)device; }

static void ev_close(forcebound_device* device) {
  if (device->runs) {
    set(&device->ending, 1);
    pthread_join(device->keeper, NULL);
  }
  close_events(device);
  free(device);
}

static const char* ev_last_error(forcebound_device* device) { return device->error; }

static const forcebound_driver kEvdev = {
    .size = sizeof kEvdev,
    .interface_version = FORCEBOUND_DEVICE_INTERFACE,
    .name = "evdev",
    .description = "mice, tablets, gamepads and 3D mice, which have no motors: forces are shown",
    .settings = "  path=FILE            such as /dev/input/event5, or a link to it as in\n"
                "                       /dev/input/by-id; the first that suits unless said\n"
                "  plane=xy|xz          what a pointer moves in; its wheel moves along the third axis\n"
                "  count_m=M            of a mouse, for one count; 0.0001 unless said\n"
                "  wheel_m=M            for one notch; 0.005\n"
                "  width_m=M            of the box in which the point moves; 0.2\n"
                "  follow_s=S           the point follows so slowly, as events come in steps; 0.01\n"
                "  damping_N_s_per_m=B  of the device that the law takes it for; 5\n"
                "  force_N_max=N        likewise; 10\n",
    .open = ev_open,
    .describe = ev_describe,
    .start = ev_start,
    .read = ev_read,
    .command = ev_command,
    .stop = ev_stop,
    .close = ev_close,
    .last_error = ev_last_error,
};

const forcebound_driver* forcebound_driver_entry(uint32_t wanted) {
  (void)wanted;
  return &kEvdev;
}
