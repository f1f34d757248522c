/* What libevdev says of an input device, for the point in the scene and the buttons (evdev_state.h). */
#ifndef FORCEBOUND_DRIVERS_EVDEV_EVENTS_H
#define FORCEBOUND_DRIVERS_EVDEV_EVENTS_H

#include <errno.h>
#include <libevdev/libevdev.h>
#include <stddef.h>

#include "evdev_state.h"

#define EVDEV_EVENTS_MOST 256

/* Whether relative events tell how far a cap is deflected, along three axes and about them: no mouse turns. */
static inline int evdev_is_a_cap(const struct libevdev* events) {
  unsigned int code;
  for (code = REL_X; code <= REL_RZ; ++code) {
    if (!libevdev_has_event_code(events, EV_REL, code)) return 0;
  }
  return 1;
}

/* Ranges and present values of a device that was opened, buttons that are held among them; a relative point stays where
 * it was. */
static inline void evdev_begin(evdev_state* state, const struct libevdev* events) {
  static const unsigned int kCodes[] = {ABS_X, ABS_Y, ABS_Z, ABS_RY};
  unsigned int code;
  size_t i;
  state->absolute = !libevdev_has_event_code(events, EV_REL, REL_X);
  state->deflects = !state->absolute && evdev_is_a_cap(events);
  state->buttons = 0;
  for (code = BTN_MISC; code < KEY_MAX; ++code) {
    if (libevdev_get_event_value(events, EV_KEY, code) != 0) evdev_note(state, EV_KEY, code, 1);
  }
  /* A gamepad's ABS_Z is a trigger, a 3D mouse's ABS_RY a turn. */
  state->z_code = libevdev_has_event_code(events, EV_KEY, BTN_GAMEPAD) ? ABS_RY : ABS_Z;
  for (i = 0; state->absolute && i < sizeof kCodes / sizeof *kCodes; ++i) {
    const struct input_absinfo* const about = libevdev_get_abs_info(events, kCodes[i]);
    double sign;
    const int axis = evdev_axis_of(state, EV_ABS, kCodes[i], &sign);
    if (about == NULL || axis < 0) continue;
    state->ranges[axis].minimum = about->minimum;
    state->ranges[axis].maximum = about->maximum;
    evdev_note(state, EV_ABS, kCodes[i], about->value);
  }
}

/* libevdev_next_event. */
typedef int (*evdev_next)(struct libevdev* events, unsigned int flags, struct input_event* event);

/* Takes in what waits. 0: the device is gone.
 *
 * After the kernel has dropped events libevdev tells anew what has changed. All of that is taken, since it is forgotten
 * at the next ordinary call; there is no more of it than the device has axes and buttons. */
static inline int evdev_take(evdev_state* state, evdev_next next, struct libevdev* events) {
  struct input_event event;
  unsigned int flags = LIBEVDEV_READ_FLAG_NORMAL;
  int taken = 0;
  while (taken < EVDEV_EVENTS_MOST || flags == LIBEVDEV_READ_FLAG_SYNC) {
    const int result = next(events, flags, &event);
    if (result == -EAGAIN && flags == LIBEVDEV_READ_FLAG_NORMAL) return 1;
    if (result == -EAGAIN) {
      flags = LIBEVDEV_READ_FLAG_NORMAL;
      continue;
    }
    if (result < 0) return result == -EINTR;
    if (result == LIBEVDEV_READ_STATUS_SYNC) flags = LIBEVDEV_READ_FLAG_SYNC;
    evdev_note(state, event.type, event.code, event.value);
    ++taken;
  }
  return 1;
}

#endif
