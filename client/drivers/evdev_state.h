/* What events of an input device say of a point in the scene, and of buttons; events come as arguments, no system calls.
 *
 * A device is relative, as a mouse: each event moves the point by so many counts, within a box. Or it is absolute, as a
 * tablet, a stick or the cap of a 3D mouse: the range of an axis spans the box. The cap of some 3D mice comes in relative
 * events, each of which says how far it is deflected now, EVDEV_DEFLECTION counts at most; at rest it says nothing, so
 * that an axis that is silent for kDeflected_ns is in the middle.
 *
 * Axes of Linux' input devices: x to the right, y towards the user. The scene has y away from the user, z up.
 */
#ifndef FORCEBOUND_DRIVERS_EVDEV_STATE_H
#define FORCEBOUND_DRIVERS_EVDEV_STATE_H

#include <linux/input-event-codes.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#define EVDEV_AXES 3
#define EVDEV_DEFLECTION 350

/* How far the point moves, and over which axes. */
typedef struct evdev_scale {
  double count_m;  /* of a relative device, for one count */
  double wheel_m;  /* for one notch of a wheel */
  double width_m;  /* of the box */
  double follow_s; /* the point follows with this time constant, since events come in steps */
  int upright;     /* a pointer moves in x and z, and its wheel along y; else in x and y, and its wheel along z */
} evdev_scale;

typedef struct evdev_range {
  int minimum;
  int maximum;
} evdev_range;

typedef struct evdev_state {
  evdev_scale scale;
  int absolute;
  int deflects; /* relative events say how far the cap of a 3D mouse is deflected */
  int fresh[EVDEV_AXES];        /* told since the point last followed */
  int64_t reported_ns[EVDEV_AXES];  /* when */
  unsigned int z_code; /* of an absolute device, the axis that moves it along z: ABS_RY of a gamepad, else ABS_Z */
  evdev_range ranges[EVDEV_AXES]; /* of an absolute device, of its axes */
  double reported_m[EVDEV_AXES];      /* where events put the point */
  double point_m[EVDEV_AXES];
  uint32_t buttons;
  int64_t moved_ns;
} evdev_state;

/* The scene's axis that an axis of the device moves, and in which direction. -1: none. */
static inline int evdev_axis_of(const evdev_state* state, unsigned int type, unsigned int code, double* sign) {
  const int along_y = state->scale.upright ? 2 : 1;
  const int along_z = state->scale.upright ? 1 : 2;
  *sign = 1;
  if (type == EV_REL && !state->absolute) {
    if (code == REL_X) return 0;
    if (code == REL_WHEEL) return along_z;
    *sign = -1;
    if (code == REL_Y) return along_y;
    if (code == REL_Z) return along_z;
  } else if (type == EV_ABS && state->absolute) {
    if (code == ABS_X) return 0;
    *sign = -1;
    if (code == ABS_Y) return along_y;
    if (code == state->z_code) return along_z;
  }
  return -1;
}

/* The bit of a button; -1: none of ours. */
static inline int evdev_button_of(unsigned int code) {
  static const unsigned int kFirsts[] = {BTN_MOUSE, BTN_JOYSTICK, BTN_GAMEPAD, BTN_MISC};
  unsigned int i;
  if (code == BTN_TOUCH) return 0;
  for (i = 0; i < sizeof kFirsts / sizeof *kFirsts; ++i) {
    if (code >= kFirsts[i] && code < kFirsts[i] + 16) return (int)(code - kFirsts[i]);
  }
  return -1;
}

static inline double evdev_within(double value, double most) {
  return value > most ? most : value < -most ? -most : value;
}

/* Takes one event in. */
static inline void evdev_note(evdev_state* state, unsigned int type, unsigned int code, int value) {
  const double half_m = 0.5 * state->scale.width_m;
  double sign;
  int axis;
  if (type == EV_KEY) {
    const int button = evdev_button_of(code);
    if (button >= 0 && value != 2) { /* 2 repeats a key that is held */
      state->buttons = value != 0 ? state->buttons | 1u << button : state->buttons & ~(1u << button);
    }
    return;
  }
  axis = evdev_axis_of(state, type, code, &sign);
  if (axis < 0) return;
  if (state->absolute) {
    const evdev_range range = state->ranges[axis];
    const double span = (double)range.maximum - range.minimum;
    if (span > 0) {
      const double share = ((double)value - range.minimum) / span;
      state->reported_m[axis] = evdev_within(sign * (share - 0.5) * state->scale.width_m, half_m);
    }
  } else if (state->deflects) {
    state->reported_m[axis] = evdev_within(sign * value * half_m / EVDEV_DEFLECTION, half_m);
    state->fresh[axis] = 1;
  } else {
    const double count_m = code == REL_WHEEL ? state->scale.wheel_m : state->scale.count_m;
    state->reported_m[axis] = evdev_within(state->reported_m[axis] + sign * value * count_m, half_m);
  }
}

/* Reports of a cap that is deflected follow one another within 16 ms. */
static const int64_t kDeflected_ns = 50000000;

/* Moves the point after what events told. */
static inline void evdev_follow(evdev_state* state, int64_t now_ns) {
  const double elapsed_s = state->moved_ns == 0 ? 0 : 1e-9 * (double)(now_ns - state->moved_ns);
  const double share = state->scale.follow_s > 0 ? 1 - exp(-elapsed_s / state->scale.follow_s) : 1;
  int axis;
  for (axis = 0; axis < EVDEV_AXES; ++axis) {
    if (state->fresh[axis]) state->reported_ns[axis] = now_ns;
    state->fresh[axis] = 0;
    if (state->deflects && now_ns - state->reported_ns[axis] > kDeflected_ns) state->reported_m[axis] = 0;
    state->point_m[axis] += share * (state->reported_m[axis] - state->point_m[axis]);
  }
  state->moved_ns = now_ns;
}

#endif
