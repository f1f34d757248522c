/* The C interface of drivers for haptic devices: what a driver implements, and what Forcebound may rely on.
 *
 * A driver is a shared library called forcebound-device-NAME.so that exports one function, forcebound_driver_entry. It
 * is found by `--device NAME[:KEY=VALUE,...]` in the folders of FORCEBOUND_DEVICE_PATH (colons between them), then in
 * the folder where Forcebound's own drivers are installed. It needs nothing but this header (C99 or C++).
 *
 * Units and frames: SI; metres, newtons, seconds, radians. Positions and forces are those of the tip in the scene's
 * frame: x to the user's right, y away from the user, z up; a right-handed frame, whose origin is the middle of the
 * workspace. A force is what the device does to the hand: a force along +x accelerates the tip along +x.
 *
 * Times: nanoseconds of CLOCK_MONOTONIC.
 *
 * Threads: open, describe, start and close are called on one thread, which need not be the tick's. Between start and
 * stop, read and command are called in turn on the tick's thread alone, once in each period; stop may be called on any
 * thread, also while read or command is in progress on another one, and last_error after any of them.
 *
 * Time limits: read, command and stop must return within 0.2 ms, allocate nothing, lock nothing that another thread
 * holds for longer, and never wait for a bus or a network. A driver whose transport is slower has a thread of its own:
 * read returns the newest reading with the time at which it was latched, command leaves the force where that thread
 * takes it. Such a thread should ask for real-time scheduling below the tick's, which has SCHED_FIFO 80 where the system
 * grants it; else it waits for whatever else the machine does. open may take 10 s, start 30 s (for homing), close 3 s.
 *
 * Versions: a struct begins with its size as its maker knows it. Fields are only ever added at the end; who reads a
 * struct reads no further than its size, and takes what lies beyond as zero. So a driver built against an older header
 * goes on working. FORCEBOUND_DEVICE_INTERFACE changes only if that is not possible.
 */
#ifndef FORCEBOUND_DEVICE_H
#define FORCEBOUND_DEVICE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FORCEBOUND_DEVICE_INTERFACE 1u
#define FORCEBOUND_AXES_MAX 6
#define FORCEBOUND_TEXT_BYTES 256

/* What a function of a driver returns. */
enum {
  FORCEBOUND_OK = 0,
  FORCEBOUND_STALE = 1,    /* of read: nothing new was latched since the last reading; only what HAS_EFFECTIVE tells is
                              looked at. This tick commands nothing: the force of the last one stays, for 5 ms and
                              hold_s_max at most, then it is zero. */
  FORCEBOUND_FAILED = 2,   /* not done; last_error says why. The next call may succeed. */
  FORCEBOUND_UNPLUGGED = 3 /* of read and command: the device is gone. They are called on, and succeed once it is
                              back and ready. */
};

/* One KEY=VALUE of --device. */
typedef struct forcebound_setting {
  const char* key;
  const char* value;
} forcebound_setting;

/* What is known of a device: all that the law may rely on. Every number is a bound that holds over the whole workspace:
 * P >= 0 is promised for devices that keep to them. A user's own file of facts (facts=FILE.toml) replaces all but
 * degrees_of_freedom and in_joints. Arrays have degrees_of_freedom entries, damping as many rows of as many.
 *
 * Forcebound sets `size` and zeros the rest before it calls describe. */
typedef struct forcebound_facts {
  uint32_t size;
  int32_t degrees_of_freedom; /* of position and force, 1 to 6 */
  char name[FORCEBOUND_TEXT_BYTES]; /* of the device that was opened, with its serial number if it has one */
  int32_t in_joints;  /* 0: damping, friction and steps are those of the tip's axes; 1: of the joints, and readings have
                         joints and the Jacobian */
  int32_t identified; /* 1: the bounds below were measured on this device or promised by its maker; 0: they are guesses,
                         and nothing is called passive */
  double period_s;    /* nominal length of a tick, and the shortest: each is to find a new reading. A device with a clock
                         of its own says a little more than its longest interval between readings; ticks without a new
                         one cost stiffness */
  double damping[FORCEBOUND_AXES_MAX * FORCEBOUND_AXES_MAX]; /* lower bound, row by row (row k begins at
                                                                k * degrees_of_freedom), positive definite [N s/m];
                                                                of joints [N s/m], [N m s/rad] */
  double friction[FORCEBOUND_AXES_MAX];      /* lower bound of the Coulomb friction [N], [N m] */
  double encoder_step[FORCEBOUND_AXES_MAX];  /* distance of two neighbouring readings [m], [rad]; 0: ideal */
  double actuator_step[FORCEBOUND_AXES_MAX]; /* distance of two neighbouring forces [N], [N m]; 0: ideal */
  double speed_max[FORCEBOUND_AXES_MAX];     /* no axis or joint is ever faster [m/s], [rad/s]; 0: not known */
  double force_N_max;   /* largest tip force that may be commanded, and that will be: the length of the vector */
  double hold_s_max;    /* the device or its driver holds a force without a new command until so long after it took effect,
                           never longer, then releases it; 0: it never releases */
  double release_share; /* the release begins with this share of the force, */
  double release_s;     /* held for so long */
  double latency_s;     /* at most so long from command to the force at the motors */
  double stamp_s_most;  /* a reading was latched at most so long after its stamp says, or before it */
  double force_N_continuous; /* largest tip force that the motors may give for ever without getting too hot: the root
                                mean square of the force is kept below it; 0: not known, 60 % of force_N_max is taken.
                                Not there in drivers and programs that are older: check `size` before it is set. */
} forcebound_facts;

/* Bits of forcebound_reading.has */
#define FORCEBOUND_HAS_ORIENTATION 1u
#define FORCEBOUND_HAS_BUTTONS 2u
#define FORCEBOUND_HAS_GRIPPER 4u
#define FORCEBOUND_HAS_EFFECTIVE 8u /* the driver knows when a force took effect, and when it was released */

/* Forcebound sets `size` and zeros the rest before it calls read. */
typedef struct forcebound_reading {
  uint32_t size;
  uint32_t has;       /* which of the optional fields the driver sets */
  int64_t latched_ns; /* when the encoders were sampled; never runs backwards, and is not after read's now_ns: a thread
                         that stamped a reading since then tells now_ns */
  double position_m[FORCEBOUND_AXES_MAX];
  double joint[FORCEBOUND_AXES_MAX];                          /* in_joints */
  double jacobian[FORCEBOUND_AXES_MAX * FORCEBOUND_AXES_MAX]; /* in_joints: d position / d joint, row by row */
  double orientation[4]; /* unit quaternion w, x, y, z: turns the handle's axes into the scene's */
  uint32_t buttons;      /* bit k: button k is pressed */
  uint32_t reserved;
  double gripper;        /* 0: closed, 1: open */
  int64_t effective_ns;  /* when the last force took effect at the motors; 0: it did not yet */
  int64_t released_ns;   /* when the device began to release it; 0: it is held */
} forcebound_reading;

/* All numbers are finite: where the program has none it commands zero. */
typedef struct forcebound_command {
  uint32_t size;
  uint32_t reserved;
  int64_t at_ns; /* now */
  double force_N[FORCEBOUND_AXES_MAX];
  double torque_N_m[3]; /* on the handle, scene frame; zero unless the device turns its handle */
} forcebound_command;

/* A device that was opened; only its driver knows what is in it. */
typedef struct forcebound_device forcebound_device;

/* All functions but last_error, and `settings` where a driver has none, must be there. */
typedef struct forcebound_driver {
  uint32_t size;
  uint32_t interface_version; /* FORCEBOUND_DEVICE_INTERFACE of the header that the driver was built with */
  const char* name;           /* NAME of the file's name */
  const char* description;    /* one line: which devices, through what */
  const char* settings;       /* the keys that open takes, a line each: "  serial=N  the device of that number" */

  /* Finds a device; no force yet. On failure `error` gets one line: what was looked for, where, and how to get it.
   * Unknown keys are an error. */
  int (*open)(const forcebound_setting* settings, size_t count, forcebound_device** device, char* error,
              size_t error_bytes);
  int (*describe)(forcebound_device* device, forcebound_facts* facts);
  int (*start)(forcebound_device* device); /* ready to read and command; the force is zero. Also again, after stop. */
  int (*read)(forcebound_device* device, int64_t now_ns, forcebound_reading* reading);
  int (*command)(forcebound_device* device, const forcebound_command* command);
  void (*stop)(forcebound_device* device); /* zero force at once; after the last command, in any state */
  void (*close)(forcebound_device* device); /* zero force, and all that open took is given back */
  const char* (*last_error)(forcebound_device* device); /* why the last call failed, in one line; valid until the
                                                           next. Nothing that failed: empty, or null */
} forcebound_driver;

/* The one function that a driver exports. `wanted` is the interface of the program; a driver that cannot serve it
 * returns its own table all the same, of which only size and interface_version are read then. The table stays valid. */
#if defined(__GNUC__)
#define FORCEBOUND_DRIVER_EXPORT __attribute__((visibility("default")))
#else
#define FORCEBOUND_DRIVER_EXPORT
#endif
FORCEBOUND_DRIVER_EXPORT const forcebound_driver* forcebound_driver_entry(uint32_t wanted);

#ifdef __cplusplus
}
#endif

#endif
