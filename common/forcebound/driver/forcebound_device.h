/* The C interface of drivers for haptic devices and robots: what a driver implements, and what Forcebound may rely on.
 *
 * A driver is a shared library called forcebound-device-NAME.so that exports one function, forcebound_driver_entry. It
 * is found by `--device NAME[:KEY=VALUE,...]` in the folders of FORCEBOUND_DEVICE_PATH (colons between them), then in
 * the folder where Forcebound's own drivers are installed. It needs nothing but this header (C99 or C++). A driver of a
 * robot is found by its path, `forcebound-server --follower driver:FILE.so[:KEY=VALUE,...]`, whatever its file's name.
 *
 * Units and frames: SI; metres, newtons, seconds, radians. Positions and forces are those of the tip in the scene's
 * frame: x to the user's right, y away from the user, z up; a right-handed frame, whose origin is the middle of the
 * workspace. A force is what the device does to the hand: a force along +x accelerates the tip along +x.
 *
 * Times: nanoseconds of CLOCK_MONOTONIC.
 *
 * Threads: open, describe, start and close are called on one thread, which need not be the tick's. Between start and
 * stop, read and command are called in turn on the tick's thread alone, once in each period; stop may be called on any
 * thread, also while read, command or another stop is in progress on another one, and last_error after any of them.
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
#define FORCEBOUND_JOINTS_MAX 8 /* of a robot */
#define FORCEBOUND_TEXT_BYTES 256

/* What a function of a driver returns. */
enum {
  FORCEBOUND_OK = 0,
  FORCEBOUND_STALE = 1,    /* of read: nothing new was latched since the last reading; only what HAS_EFFECTIVE tells is
                              looked at, of a robot also the sensor, the gripper and whether it stopped. This tick
                              commands nothing: the force of the last one stays, for 5 ms and hold_s_max at most, then
                              it is zero. */
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
  int32_t degrees_of_freedom; /* of position and force, 1 to 3; 6 of a device that turns its handle too: then the
                                 user's file of facts is a chain of six axes (see forcebound_command) */
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
  double torque_N_m[3]; /* on the handle, scene frame; zero unless the device turns its handle: then the user's file of
                           facts is a chain of six axes, readings have an orientation and three rows of angular velocity
                           in the Jacobian below those of the position, and the joints' torques are J' times both */
} forcebound_command;

/* What is known of a robot with a torque interface: all that its law and its controller rely on. Turning joints in a row,
 * from the base to the tool. Its world frame is that of its base: right-handed, z up, metres. Geometry and masses are
 * told with all joints at zero. A user's own file (facts=ROBOT.toml) replaces all but joints; it is refused where it has
 * a limit above, or a delay below, what is told here, or claims brakes, a sensor or a compensation of gravity that are
 * not there.
 *
 * A torque that is commanded comes *beyond* what holds the robot, its gripper and tool against gravity, unless `gravity`
 * says that the robot does not do that itself.
 *
 * Forcebound sets `size` and zeros the rest before it calls describe_robot. */
typedef struct forcebound_robot {
  uint32_t size;
  int32_t joints; /* 1 to FORCEBOUND_JOINTS_MAX, and no more than the program takes */
  char name[FORCEBOUND_TEXT_BYTES]; /* of the robot that was opened, with its serial number if it has one */
  int32_t identified; /* as in forcebound_facts */
  int32_t brakes;     /* 1: `stop` also closes brakes, which hold it; 0: it is brought to rest by its own damping */
  int32_t gravity;    /* 0: the robot compensates its weight itself; 1: Forcebound adds the torques that hold it, found
                         from the masses below and the newest good reading, also while its brakes open. Then
                         `torque_max` is what the motors can give beyond that, it must have brakes, and these must
                         close by themselves when hold_s_max ends without a new command: a server that is killed
                         calls no stop */
  int32_t reserved;
  double period_s;  /* as in forcebound_facts; the robot's loop has this period */
  double hold_s_max; /* as in forcebound_facts; > 0: a torque must end by itself when no new one comes */
  double latency_s;
  double stamp_s_most;

  /* Of the joints: the axis about which one turns by the right hand, and a point on it [m]; base frame, all at zero. */
  double axis[FORCEBOUND_JOINTS_MAX][3];
  double point_m[FORCEBOUND_JOINTS_MAX][3];
  double tool_m[3];   /* the tool's point, likewise */
  double tool_rad[3]; /* rotation vector that turns the base's axes into the tool's; the tool points along its z */
  double lowest_rad[FORCEBOUND_JOINTS_MAX]; /* the robot's own limits are to be a little wider */
  double highest_rad[FORCEBOUND_JOINTS_MAX];
  double rest_rad[FORCEBOUND_JOINTS_MAX];  /* a posture far from limits and singular ones */
  double speed_max[FORCEBOUND_JOINTS_MAX]; /* largest that it may have, > 0 [rad/s]: half as much again stops the robot,
                                              and no joint is ever four times as fast: such a reading is not believed */
  double torque_max[FORCEBOUND_JOINTS_MAX]; /* largest that may be commanded, and that then will be, > 0 [N m] */
  double torque_rate_max[FORCEBOUND_JOINTS_MAX]; /* fastest that a torque may be asked to change [N m/s]; 0: at once. The
                                                    law, a fault or a stop may still end one at once */
  double damping[FORCEBOUND_JOINTS_MAX];  /* lower bound of what the joint itself dissipates, > 0 [N m s/rad]. Where
                                             `gravity` is 1, less what a sampled, held and delayed weight g(q) gives back:
                                             the sum over k of |dg_i/dq_k| (period_s / 2 + latency_s) */
  double friction[FORCEBOUND_JOINTS_MAX]; /* likewise, Coulomb friction [N m] */
  double encoder_step[FORCEBOUND_JOINTS_MAX];  /* [rad]; 0: ideal */
  double actuator_step[FORCEBOUND_JOINTS_MAX]; /* [N m]; 0: ideal */
  double tool_speed_m_per_s_max;    /* > 0: half as much again stops the robot */
  double tool_turn_rad_per_s_max; /* > 0: likewise */

  /* Of the link behind each joint, up to the next one, with all that is fixed to it. */
  double mass_kg[FORCEBOUND_JOINTS_MAX];
  double centre_m[FORCEBOUND_JOINTS_MAX][3];       /* of the mass; base frame, all joints at zero */
  double inertia_kg_m2[FORCEBOUND_JOINTS_MAX][6]; /* about that: xx, yy, zz, xy, xz, yz along the base's axes */
  double rotor_kg_m2[FORCEBOUND_JOINTS_MAX];      /* the motor's inertia, seen behind its gear */

  /* Of the force sensor between flange and tool. */
  double sensor_period_s; /* 0: there is none */
  double sensor_N_sd;     /* standard deviation of the noise of each axis */
  double sensor_N_m_sd;
  double sensor_bias_N_max; /* largest constant error of each axis */
  double sensor_bias_N_m_max;
} forcebound_robot;

/* Bits of forcebound_robot_reading.has, beside HAS_GRIPPER and HAS_EFFECTIVE. */
#define FORCEBOUND_HAS_SENSED 16u  /* a sample of the force sensor */
#define FORCEBOUND_HAS_ENERGY 32u  /* of simulated robots: energy_J and energy_J_least */
#define FORCEBOUND_IS_STOPPED 64u  /* its brakes hold or are about to close or open, whoever asked for it */

/* Forcebound sets `size` and zeros the rest before it calls read_robot. */
typedef struct forcebound_robot_reading {
  uint32_t size;
  uint32_t has;
  int64_t latched_ns; /* as in forcebound_reading, as are effective_ns and released_ns */
  double position_rad[FORCEBOUND_JOINTS_MAX];
  int64_t effective_ns;
  int64_t released_ns;
  double force_N[3];    /* what the tool exerts on its surroundings, without its own weight and inertia; base frame */
  double torque_N_m[3]; /* likewise, about the tool's point; zeros of a sensor that has none */
  int64_t sensed_ns;    /* when that was sampled; not after now_ns. A sample counts for ten periods of the sensor */
  double gripper;       /* 0: closed, 1: open */
  double energy_J;      /* what the joints dissipated less what the commanded torques gave, since the start, exactly, */
  double energy_J_least; /* and the least that it ever was */
} forcebound_robot_reading;

/* All numbers are finite. No torque is above its largest, but for what holds the weight where `gravity` is 1: of a joint
 * at most the sum, over the links behind it, of 9.81 m/s^2 * mass * distance of its centre from the joint's point.
 * There is no command before the first good reading; after one that is not good, it is what holds the weight alone. */
typedef struct forcebound_robot_command {
  uint32_t size;
  uint32_t has; /* HAS_GRIPPER: the gripper shall move to `gripper` */
  int64_t at_ns;
  double torque_N_m[FORCEBOUND_JOINTS_MAX];
  double gripper; /* 0: closed, 1: open */
} forcebound_robot_command;

/* A device or robot that was opened; only its driver knows what is in it. */
typedef struct forcebound_device forcebound_device;

/* All functions but last_error must be there, and `settings` unless a driver has none: of a device without those of
 * robots at the end, of a robot those in place of describe, read and command. A driver may serve both. */
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

  /* Of robots; not there in drivers that are older. Threads and time limits as for describe, read and command. `stop`
   * ends the torque at once and closes the brakes, if it has some. If another call is in progress meanwhile, it is called
   * again once that has returned, so that it has the last word. */
  int (*describe_robot)(forcebound_device* robot, forcebound_robot* facts);
  int (*read_robot)(forcebound_device* robot, int64_t now_ns, forcebound_robot_reading* reading);
  int (*command_robot)(forcebound_device* robot, const forcebound_robot_command* command); /* while stopped only after
                                              resume, where `gravity` is 1: what holds the weight as the brakes open */
  int (*resume)(forcebound_device* robot); /* after stop, on the thread of read_robot: begins to open the brakes. Until
                                              they are open read_robot tells IS_STOPPED. If that takes more than 2 s, or
                                              resume fails, stop is called: then they must not open any more */
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
