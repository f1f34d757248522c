/* libforcebound: force bounding laws, a client and a server of networked haptics, for programs in C, in C++ and in all
 * languages that call C.
 *
 * Units and frames: SI; metres, newtons, seconds, radians. A position is that of the device's tip in the scene's frame:
 * x to the user's right, y away from the user, z up. A force is what the device does to the hand: a wall at x >= 0 gives
 * f = -K x. Arrays have one number for each degree of freedom of the tip ("axes") or for each joint; what a struct has
 * room for beyond these is not read.
 *
 * Errors: a function that can fail returns an fb_status, and what it was to give is then as it was before, but for
 * forces, which are zero. `fb_last_error` says in one line what was wrong, where, and what would be accepted. No C++
 * exception leaves the library, and one that a callback of yours throws ends there: zero force, and counted.
 *
 * Structs and versions: a struct begins with its size as the program that is built with it knows it. FB_INIT sets it and
 * zeros the rest, which stands for the standard value wherever one is named:
 *
 *     fb_motion motion = FB_INIT(fb_motion);
 *
 * Fields are only ever added at the end. The library reads and writes no further than `size`, and takes what lies beyond
 * as zero: a program built with an older header goes on working. A struct that is larger than the library's own is
 * accepted if all that the library does not know is zero. Functions never change: FB_ABI does, with the library's name.
 *
 * Threads: any function may be called on any thread, but what belongs to one handle by one thread at a time unless its
 * function says otherwise.
 *
 * Real time: "tick" marks functions for a loop of 1 kHz: if they succeed they allocate nothing, take no lock, make no
 * system call, and take a bounded time. All others may do all of that. */
#ifndef FORCEBOUND_H
#define FORCEBOUND_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(_WIN32) && defined(forcebound_c_EXPORTS)
#define FB_EXPORT __declspec(dllexport)
#elif defined(__GNUC__) && !defined(_WIN32)
#define FB_EXPORT __attribute__((visibility("default")))
#else
#define FB_EXPORT
#endif

#define FB_ABI 1
#define FB_AXES_MAX 6    /* degrees of freedom of a tip */
#define FB_JOINTS_MAX 7  /* of a device */
#define FB_TEXT_BYTES 256

/* A struct of the library with its size set and all else zero. */
#ifdef __cplusplus
#define FB_INIT(type) (::forcebound_c::initial<type>())
#else
#define FB_INIT(type) {.size = sizeof(type)}
#endif

/* What a function returns. */
typedef int32_t fb_status;
enum {
  FB_OK = 0,
  FB_INVALID = 1,     /* an argument is not what it has to be */
  FB_FAILED = 2,      /* a file, a device, a network or the system refuses */
  FB_NOT_NOW = 3,     /* not in this state: it runs, it has ended, it is in use */
  FB_NOTHING = 4,     /* there is none, such as an event; no error */
  FB_TOO_SMALL = 5,   /* a buffer: the text was cut */
  FB_NO_MEMORY = 6
};

/* Why the last function failed that failed on this thread, in one line without an end of line; empty: none did. Valid
 * until the next one fails there. Never null. */
FB_EXPORT const char* fb_last_error(void);

/* "0.2.0", of the library that runs. */
FB_EXPORT const char* fb_version(void);

/* ---- Facts: what is known of a haptic device, and all that a law relies on. Read once, then constant. */

typedef struct fb_facts fb_facts;

/* Of a device that ships ("omni"), or of a TOML file by its path (with a '/', or ending with ".toml"), as
 * /usr/share/forcebound/devices has them. */
FB_EXPORT fb_status fb_facts_load(const char* name_or_path, fb_facts** facts);

/* Of TOML text. `name` is the device's, for errors. */
FB_EXPORT fb_status fb_facts_parse(const char* toml, const char* name, fb_facts** facts);

/* Null is accepted. What was made with them goes on. */
FB_EXPORT void fb_facts_destroy(fb_facts* facts);

typedef struct fb_facts_info {
  size_t size;
  char name[FB_TEXT_BYTES];
  int32_t axes;       /* degrees of freedom of the tip: of positions and forces; the last three are rotations and torques
                         where `rotations` is 3 */
  int32_t rotations;  /* 0 or 3 */
  int32_t joints;
  int32_t cartesian;  /* 1: joints are the axes of the tip, and motions need neither joints nor a Jacobian */
  int32_t identified; /* 0: the bounds are guesses, and nothing is called passive */
  int32_t reserved;
  double period_s;    /* nominal length of a tick */
  double force_N_max;
  double torque_N_m_max; /* 0: it shows none */
  double latency_s;      /* from the command to the force at the motors */
  double hold_s_max;     /* the device holds a force for so long without a new one; 0: it never releases */
} fb_facts_info;

FB_EXPORT fb_status fb_facts_describe(const fb_facts* facts, fb_facts_info* info);

/* ---- A law: bounds each force so that the device returns no more energy than its own damping took. */

typedef struct fb_law fb_law;

/* The name of a law that ships, from 0 on; null: there are no more. */
FB_EXPORT const char* fb_law_name(size_t index);

typedef struct fb_law_options {
  size_t size;
  const char* parameters; /* TOML with a table for each law, "[vc]\ncoupling_N_per_m = 40000\n"; null: standard values */
  int32_t full_memory;    /* 1: fba-less and fba-exact keep all energy for later; 0: what the largest force can need */
  int32_t reserved;
} fb_law_options;

/* @param name "fba-exact", "fba-less", "fba-more", "none", ...; a law that has another half at the server is refused
 * @param options null: standard values
 * FB_INVALID: an unknown law or parameter, or a device that the law refuses. */
FB_EXPORT fb_status fb_law_create(const char* name, const fb_facts* facts, const fb_law_options* options, fb_law** law);
FB_EXPORT void fb_law_destroy(fb_law* law);

/* Bits of fb_motion.has: which fields the program sets. Those it leaves out are by the facts. */
enum {
  FB_HAS_LATENCY = 1,     /* latency_s */
  FB_HAS_LATENCY_MAX = 2, /* latency_s_max */
  FB_HAS_EFFECT = 4,      /* effect_s */
  FB_HAS_HELD = 8         /* held_s */
};

/* What a tick measured. */
typedef struct fb_motion {
  size_t size;
  uint32_t has;
  int32_t write_failed; /* 1: whether the last force was ever in effect, or the one before it still is, is unknown */
  double interval_s;    /* between the reading before and this one, measured; 0 at the first. One that no clock can have
                           measured credits nothing */
  double position[FB_AXES_MAX]; /* of the tip [m]; of one that turns, below it the sum of the rotation vectors of all
                                   intervals, each about the pose at its beginning [rad]. Not finite: the reading is lost */
  double joint[FB_JOINTS_MAX];  /* readings of the encoders [m], [rad]; not of a Cartesian device */
  double jacobian[FB_AXES_MAX * FB_JOINTS_MAX]; /* d position / d joint, row by row; row k begins at k * joints. Likewise */
  double latency_s;     /* from the reading before to the effect of the force that was chosen on it */
  double latency_s_max; /* longest from this reading to the effect of the force that is chosen now */
  double effect_s;      /* as latency_s, but reported by the device */
  double held_s;        /* from that effect until the device let go of the force */
} fb_motion;

/* One tick: notes the motion and gives the force for the device, which the law then takes for commanded.
 *
 * After any error the force is zero; if `law` is not null it counts the reading as lost, so that a force is never charged
 * too little.
 *
 * @param request_N what the environment asks for; null: nothing, or what it asked for is too old
 * @param axes numbers of both arrays: fb_facts_info.axes
 * FB_INVALID: another number of axes, a null pointer, a size of `motion` that is none. Tick. */
FB_EXPORT fb_status fb_law_tick(fb_law* law, const fb_motion* motion, const double* request_N, double* force_N,
                                size_t axes);

/* For a loop that knows only when it commands: the force that the last tick gave, or zero if it takes effect so long
 * after the reading that it is not allowed any more. @param latency_s from the reading to the effect. Tick. */
FB_EXPORT fb_status fb_law_confirm(fb_law* law, double latency_s, double* force_N, size_t axes);

/* The account of a law, and what it counted. */
typedef struct fb_ledger {
  size_t size;
  double energy_J;    /* that the law may spend now */
  double share_credited; /* of the coming interval's dissipation that the law will credit, 0 to 1 (the paper's xi) */
  int32_t audited;    /* 1: the device is simulated, and P is known: what it dissipated less what its motors returned */
  int32_t reserved;
  double P_J;         /* now, */
  double P_J_least;   /* and the least that it ever was: below zero, not passive */
  uint64_t requests_not_finite;
  uint64_t readings_not_finite;
  uint64_t readings_too_far;       /* further than the device can be so soon: taken for lost */
  uint64_t writes_failed;          /* as fb_motion says */
  uint64_t effects_outside_facts;  /* reported when the facts do not allow it */
  uint64_t releases_outside_facts; /* likewise */
  uint64_t intervals_impossible;   /* not measurable: nothing credited */
  uint64_t saturated;              /* requests above the device's largest force */
  uint64_t forces_not_finite;      /* of the law: a fault of its own */
  uint64_t forces_withdrawn;       /* chosen, but too late: zero */
  uint64_t calls_refused;          /* of fb_law_tick, for its arguments */
} fb_ledger;

/* Of the thread that ticks. A law alone is never audited. Tick. */
FB_EXPORT fb_status fb_law_ledger(const fb_law* law, fb_ledger* ledger);

/* ---- A leader arm: feedback in its joints that cannot make it return more energy than these dissipate. Any number of
 * joints, each bounded by an fba-exact of its own; loops of 10 to 10000 Hz, and any jitter up to hold_s_max.
 *
 *     fb_leader_step(leader, position_rad, feedback_N_m, interval_s, torque_N_m, joints)
 *
 * A torque is what the servo does to the joint, positive as the angle, which is unwrapped. A servo takes torques,
 * currents or voltages; or goal positions together with a torque limit: a goal out of reach on the side of the torque,
 * the limit its size; or goal positions alone, where goal_stiffness_N_m_per_rad is soft enough, else that is refused. */

typedef struct fb_leader fb_leader;

/* What is known of a joint and its servo, at the joint: bounds, of which the truth is never worse. */
typedef struct fb_leader_joint {
  size_t size;
  const char* name;             /* for errors; null: its number */
  double damping_N_m_s_per_rad; /* at least, while the servo is on: a motor driven by voltage brakes too */
  double friction_N_m;          /* dry friction, at least */
  double encoder_step_rad;      /* 2 pi / 4096, say */
  double backlash_rad;          /* play between encoder and motor, from stop to stop */
  double torque_N_m_max;        /* the most that it may be asked for */
  double torque_step_N_m;       /* of two neighbouring commands; 0: any */
  double torque_gain_share;     /* its torque is the command times one constant, 1 and up to so much less or more, */
  double torque_ripple_share;   /* and off by up to this share, another one at each instant */
  double speed_rad_per_s_max;   /* never exceeded: a reading beyond is lost; 0: not known */
  double goal_stiffness_N_m_per_rad; /* 0: it takes torques; else goals, and pulls there as a spring: constant, without
                                        integral part, profile, dead zone or least torque */
  double goal_rad_least;             /* of goals; both 0: any */
  double goal_rad_most;
} fb_leader_joint;

typedef struct fb_leader_settings {
  size_t size;
  double period_s;         /* nominal, between steps; 0: 1/60 */
  double latency_s_max;    /* from a reading's stamp until the torque that is chosen on it acts */
  double read_s_max;       /* of that, until the servos latch their positions */
  double hold_s_max;       /* later steps count as late; 0: two periods and the latency. */
  double watchdog_s_least; /* 0: servos hold a torque until the next one, and late steps are not passive; else they let
                              go by themselves, no sooner than this and no later than hold_s_max */
  double clock_share;      /* the clock is fast or slow by up to this share; 0: 1e-4 */
  double memory_J;         /* no joint saves more for later; 0: 0.1 */
} fb_leader_settings;

/* @param joints an array, each element of the same size @param settings null: standard values, and no latency
 * FB_INVALID: which joint's number is not what it has to be. */
FB_EXPORT fb_status fb_leader_create(const fb_leader_joint* joints, size_t count, const fb_leader_settings* settings,
                                     fb_leader** leader);

/* Null is accepted. */
FB_EXPORT void fb_leader_destroy(fb_leader* leader);

/* Notes the readings and gives the torques to command now. A reading that is not finite or further than the joint can
 * be so soon is lost: its torque is zero, the others are not affected.
 *
 * @param feedback_N_m what follower or simulation ask for, say stiffness * (follower - leader); not finite: zero; null:
 *        there is none, or it is too old
 * @param interval_s since the stamp of the step before, measured; of the first step not read. Not above zero: torques
 * are zero until those before are over
 * @param joints numbers of the arrays
 * FB_INVALID: another number of joints, a null pointer. Torques are zero, and the readings lost. Tick. */
FB_EXPORT fb_status fb_leader_step(fb_leader* leader, const double* position_rad, const double* feedback_N_m,
                                   double interval_s, double* torque_N_m, size_t joints);

/* The torques of the last step may not have been written, or not in time: those before may act still. Tick. */
FB_EXPORT fb_status fb_leader_write_failed(fb_leader* leader);

/* What to write to servos that take goals; not a number for others, and where no reading was good yet. Tick. */
FB_EXPORT fb_status fb_leader_goals(const fb_leader* leader, double* goal_rad, size_t joints);

typedef struct fb_leader_state {
  size_t size;
  double energy_J_least;         /* of the joint that may spend least now */
  uint64_t readings_lost;        /* each joint's */
  uint64_t feedback_not_finite;  /* likewise */
  uint64_t saturated;            /* likewise, above its largest torque */
  uint64_t intervals_impossible; /* of steps */
  uint64_t late;                 /* of servos without a watchdog: not passive */
  uint64_t writes_failed;
  uint64_t calls_refused; /* of fb_leader_step, for its arguments */
} fb_leader_state;

/* Tick. */
FB_EXPORT fb_status fb_leader_look(const fb_leader* leader, fb_leader_state* state);

/* ---- A device: one of ours, or callbacks of yours. */

typedef struct fb_device fb_device;

/* @param device simulated ("omni", or the path of its TOML file), or behind a driver plug-in ("evdev:path=...", looked for
 *        in the folders of FORCEBOUND_DEVICE_PATH and where drivers are installed beside this library)
 * @param hand that moves a simulated device ("trace-sphere", "press:axis=0,..."); null: its default. A driver crashing
 *        ends the process, after the device was stopped. */
FB_EXPORT fb_status fb_device_open(const char* device, const char* hand, fb_device** opened);

/* Bits of fb_reading.has: which of the optional fields the program sets. */
enum { FB_HAS_BUTTONS = 16, FB_HAS_GRIPPER = 32, FB_HAS_ORIENTATION = 64 };

/* One reading of the device. The library sets size and `latched_ns` and zeros the rest before it asks. */
typedef struct fb_reading {
  size_t size;
  uint32_t has;
  uint32_t buttons;   /* bit k: button k is pressed */
  int64_t latched_ns; /* when the encoders were sampled, CLOCK_MONOTONIC; now, unless the program knows it better. The same
                         as before: nothing new was read */
  double position_m[FB_AXES_MAX]; /* as in fb_motion, without rotations: these are in `orientation` */
  double joint[FB_JOINTS_MAX];
  double jacobian[FB_AXES_MAX * FB_JOINTS_MAX];
  double orientation[4]; /* unit quaternion w, x, y, z: turns the handle's axes into the scene's */
  double gripper;        /* 0: closed, 1: open */
} fb_reading;

/* The callbacks of a device. They return FB_OK or anything else for "not done". A callback that takes more than 10 ms, or
 * throws, has failed too: no force until there is a reading again, and counted (fb_client_state). */
typedef struct fb_device_callbacks {
  size_t size;
  void* user; /* for all of them */
  /* On the client's thread, 1000 times a second: to return within 0.2 ms, without waiting or allocating. */
  fb_status (*read)(void* user, fb_reading* reading);
  /* Commands a force [N], and below it a torque if the device shows one, until the next one. Likewise, after `read`. */
  fb_status (*command)(void* user, const double* force_N, size_t axes);
  /* Zero force at once. On any thread, also while another callback is in progress: after a tick that does not come. Null:
   * `command` of zeros is called in its place. */
  void (*stop)(void* user);
  /* Ready to read, zero force; before the first reading. Null: it always is. */
  fb_status (*start)(void* user);
} fb_device_callbacks;

/* @param facts of the device: copied. A person's limits hold unless the facts' [safety] says otherwise. */
FB_EXPORT fb_status fb_device_of_callbacks(const fb_facts* facts, const fb_device_callbacks* callbacks,
                                           fb_device** device);

/* Null is accepted. A client that was made with it keeps it, and with it the callbacks, until its own end. */
FB_EXPORT void fb_device_destroy(fb_device* device);

/* ---- A client: the device and a law at work against a server, on a thread of its own. */

typedef struct fb_client fb_client;

/* Only `server` has to be there. */
typedef struct fb_client_settings {
  size_t size;
  const char* server;         /* HOST:PORT */
  const char* scene;          /* null: the server's default */
  const char* law;            /* null: "fba-exact"; or the file of one of yours, "./my-law.so" (forcebound_law.h) */
  const char* law_parameters; /* as fb_law_options.parameters */
  const char* key;            /* file of the client's secret key; null: a new one */
  const char* server_key;     /* the server's public key in base64, or its file */
  const char* known_servers;  /* file of servers and their keys */
  const char* shared_key;     /* file of a key that the server has too */
  const char* recording;      /* MCAP file of each tick and force; null: none */
  double duration_s;          /* 0: until stopped */
  int32_t trust_new;          /* 1: the key of a new server is believed, and added to known_servers */
  int32_t insecure;           /* 1: not encrypted to other machines too */
  int32_t remote_rendering;   /* 1: nothing of the scene is run here */
  int32_t once;               /* 1: give up if the server does not answer for 5 s, or refuses another session */
} fb_client_settings;

/* Looks up the server, opens the recording, reads the keys. A device serves one client at a time. */
FB_EXPORT fb_status fb_client_create(const fb_client_settings* settings, fb_device* device, fb_client** client);

/* Starts the thread, and on it the device. Once. If the device does not start, the client ends, and fb_client_wait says
 * why. */
FB_EXPORT fb_status fb_client_start(fb_client* client);

/* Waits until it has ended: its time is up, it gave up, or it was stopped. FB_NOT_NOW: it still runs after so long, or was
 * not started. FB_FAILED: there never was a session, and why. @param timeout_s below 0: however long it takes */
FB_EXPORT fb_status fb_client_wait(fb_client* client, double timeout_s);

/* Zero force, then says good-bye to the server, which takes up to 3 s. Any thread. As fb_client_wait. */
FB_EXPORT fb_status fb_client_stop(fb_client* client);

/* Stops it first. Null is accepted. */
FB_EXPORT void fb_client_destroy(fb_client* client);

enum { FB_SESSION_CONNECTING = 0, FB_SESSION_ACTIVE = 1, FB_SESSION_STALE = 2, FB_SESSION_RECONNECTING = 3 };

/* The newest tick. */
typedef struct fb_client_state {
  size_t size;
  uint64_t ticks;      /* so far; 0: there was none, and what follows is zero */
  int32_t running;     /* 0: not yet, or not any more */
  int32_t session;     /* FB_SESSION_... */
  double position_m[FB_AXES_MAX];
  double request_N[FB_AXES_MAX]; /* what was asked for, and below it the torque [N m] */
  double force_N[FB_AXES_MAX];   /* what the law made of it: commanded */
  double force_age_s;  /* since the reading that the newest answer of the server is for */
  int32_t contact;     /* 1: something is touched, */
  uint32_t buttons;
  double depth_m;      /* so deep */
  double orientation[4]; /* zeros: none */
  double gripper;
  uint64_t callbacks_failed; /* they said so, or threw */
  uint64_t callbacks_late;   /* took more than 10 ms */
  uint64_t events_lost;      /* more than 1000 waited */
  char simulated[FB_TEXT_BYTES]; /* what the server simulates; empty: no session yet */
} fb_client_state;

/* Any thread, at any time. Never makes the tick wait. */
FB_EXPORT fb_status fb_client_look(fb_client* client, fb_client_state* state);

/* The account of its law at the newest tick, and P where the device is simulated; the counts are in the summary. */
FB_EXPORT fb_status fb_client_ledger(fb_client* client, fb_ledger* ledger);

/* What happened, for a log. */
enum {
  FB_EVENT_WELCOMED = 0,       /* a session; text: what is simulated */
  FB_EVENT_REFUSED = 1,        /* text: the server's reason */
  FB_EVENT_SESSION_UNKNOWN = 2,
  FB_EVENT_SERVER_LEFT = 3,
  FB_EVENT_FORCE_FADING = 4,   /* the newest force is `duration_s` old */
  FB_EVENT_FORCE_DROPPED = 5,
  FB_EVENT_FORCE_FRESH = 6,
  FB_EVENT_SCENE_HERE = 7,     /* all of it that runs here */
  FB_EVENT_SCENE_REFUSED = 8,
  FB_EVENT_LIMITED = 9,        /* by a limit for the hand; text: which, and what ends it */
  FB_EVENT_DEVICE_GONE = 10,   /* no readings; text: why */
  FB_EVENT_NO_TORQUE = 11,
  FB_EVENT_DEVICE_BACK = 12,
  FB_EVENT_FOLLOWER = 13,      /* the robot at the far end does something else */
  FB_EVENT_TOOL_LOST = 14,     /* the scene's tool: the device does not tell its orientation */
  FB_EVENT_PROBLEM = 1000      /* text: of names, keys, handshakes, the recording */
};

typedef struct fb_event {
  size_t size;
  int32_t kind; /* FB_EVENT_...; programs ignore those that they do not know */
  int32_t reserved;
  double duration_s;
  char text[1024];
} fb_event;

/* The oldest that waits, which then is taken. FB_NOTHING: none does. Any thread. */
FB_EXPORT fb_status fb_client_event(fb_client* client, fb_event* event);

/* After the end: JSON, as `forcebound-client --summary` writes it; allocations in ticks are not counted here.
 * @param text may be null if `bytes` is 0 @param needed of the whole text with its zero; may be null
 * FB_TOO_SMALL: cut to what fits. */
FB_EXPORT fb_status fb_client_summary(fb_client* client, char* text, size_t bytes, size_t* needed);

/* ---- A server: an environment of yours for any number of clients, on a thread of its own. */

typedef struct fb_server fb_server;

/* A client that asks for the environment, by its own account. */
typedef struct fb_client_facts {
  size_t size;
  char device[FB_TEXT_BYTES];
  int32_t axes;
  int32_t renders_locally; /* 1: it takes a stiffness */
  int32_t shows_torque;    /* 1: it takes a torque on the handle */
  int32_t reserved;
  double period_s;         /* between its motions */
  double force_N_max;
  double round_trip_s;     /* 0: not measured */
} fb_client_facts;

/* A motion of its device. */
typedef struct fb_client_motion {
  size_t size;
  uint32_t has;     /* FB_HAS_BUTTONS, FB_HAS_GRIPPER, FB_HAS_ORIENTATION */
  uint32_t buttons; /* bit k: button k is pressed */
  int64_t read_ns;    /* the client's clock at the reading: it may jump, and be wrong on purpose */
  int64_t arrived_ns; /* CLOCK_MONOTONIC at its arrival here */
  double position_m[FB_AXES_MAX]; /* as in fb_motion; finite */
  double orientation[4]; /* unit quaternion w, x, y, z: turns the handle's axes into the scene's */
  double gripper;        /* 0: closed, 1: open */
} fb_client_motion;

/* Bits of fb_answer.has. */
enum {
  FB_HAS_TORQUE = 128,    /* torque_N_m */
  FB_HAS_CONTACT = 256,   /* normal, depth_m */
  FB_HAS_STIFFNESS = 512  /* stiffness_N_per_m, radius_m */
};

/* The answer to a motion. The library sets size and zeros the rest before it asks. */
typedef struct fb_answer {
  size_t size;
  uint32_t has;
  uint32_t reserved;
  double force_N[FB_AXES_MAX];
  double torque_N_m[3];       /* on the handle, for a device whose motions have no rotations */
  double normal[FB_AXES_MAX]; /* unit, out of the surface that is touched, for people to see */
  double depth_m;             /* below it */
  /* K of x, y and z, row by row: to a client that renders locally the force is f - K (x - x_0), at its own rate, for
   * radius_m about the motion's position x_0. Otherwise it holds f until the next answer. */
  double stiffness_N_per_m[9];
  double radius_m;
} fb_answer;

/* An environment. All callbacks come on the server's thread, one at a time, while every other client waits. They return
 * FB_OK or anything else for "not done". A client whose `update` failed, threw or gave what is not finite gets zero
 * force; one that took more than 10 ms is answered late. Both are counted (fb_server_state). */
typedef struct fb_environment {
  size_t size;
  const char* name;      /* by which clients may ask for it, as for a scene; null: "environment" */
  const char* simulated; /* what it is, in one line for people; null: its name */
  int32_t axes;          /* of the devices that it accepts; 0: any */
  int32_t reserved;
  void* user;            /* of `create` */
  /* A client comes: `own` is for its motions. Not done: it is refused, and may ask again. Null: `own` is `user`. */
  fb_status (*create)(void* user, const fb_client_facts* client, void** own);
  /* Real time: to return within a tick, without waiting or allocating. */
  fb_status (*update)(void* own, const fb_client_motion* motion, fb_answer* answer);
  /* The client has left, or came to nothing after `create`. Null: nothing is to be done. */
  void (*destroy)(void* own);
} fb_environment;

/* Nothing has to be set. Errors of address and keys name them as forcebound-server does: --listen, --key, --clients,
 * --psk (shared_key), --insecure. */
typedef struct fb_server_settings {
  size_t size;
  const char* listen;     /* HOST:PORT; null: "127.0.0.1:47800"; port 0: a free one, see fb_server_state */
  const char* key;        /* file of the server's secret key; takes `clients`, `shared_key` or both */
  const char* clients;    /* TOML file of the clients that are let in */
  const char* shared_key; /* file of a key that all clients have too */
  int32_t insecure;       /* 1: other machines are served, not encrypted */
  int32_t clients_max;    /* at once; 0: 64 */
  int32_t clients_per_address; /* at once, of one IP address; 0: as many */
  int32_t reserved;
  double idle_s;          /* a client ends that sends no motion for so long; 0: 60 s */
} fb_server_settings;

/* Takes the address, reads the keys, copies the environment. @param settings null: standard values */
FB_EXPORT fb_status fb_server_create(const fb_server_settings* settings, const fb_environment* environment,
                                     fb_server** server);

/* ---- A simulator of yours that steps on its own thread at its own rate, from 20 Hz on, in real time.
 *
 * Each device touches it with a probe: a ball on a virtual coupling, which the server moves at the device's rate. Before a
 * step the simulator asks where the probes are and what they pushed since it asked last; after it, it reports what each
 * probe meets. Until the next report the probe goes on against that, here and at a client that renders locally.
 *
 *     for (;;) {
 *       fb_server_ask(server, &probes);
 *       for (k = 0; k < probes; ++k)
 *         for (i = 0; fb_server_push(server, k, i, &push) == FB_OK; ++i) ...   apply push.impulse_Ns / step at push.place_m
 *       ...                                                                   step
 *       for (k = 0; fb_server_probe(server, k, &probe) == FB_OK; ++k)
 *         fb_server_report(server, probe.client, touches, count);             what is at probe.place_m now
 *     }
 *
 * Probes push as hard as the hand is asked to feel; of that the law at the device may apply less. Without a report for
 * 0.25 s a probe's force and pushes fade, to zero after 1 s. One thread at a time asks, reads and reports. */

#define FB_TOUCHES_MAX 3 /* of a probe */

/* Only `size` has to be set. */
typedef struct fb_simulator {
  size_t size;
  const char* name;      /* by which clients may ask for it, as for a scene; null: "simulator" */
  const char* simulated; /* what it is, in one line for people; null: its name */
  double probe_radius_m;          /* 0: a point; up to 1 */
  double probe_mass_kg;           /* 0.001 to 100; 0: 0.03 */
  double probe_stiffness_N_per_m; /* of the coupling, up to 1e5: no wall feels harder; 0: 2000 */
  double probe_damping_N_s_per_m; /* up to 1e4; 0: 8 */
} fb_simulator;

/* As fb_server_create. */
FB_EXPORT fb_status fb_server_of_simulator(const fb_server_settings* settings, const fb_simulator* simulator,
                                           fb_server** server);

/* A client's probe as it was asked for. */
typedef struct fb_probe {
  size_t size;
  uint64_t client;   /* a number that no other client has, before or after */
  double interval_s; /* since it was asked for before, by motions that came; 0: the first time, or none came */
  double place_m[3]; /* its centre */
  double velocity_m_per_s[3];
  double device_m[3];
  uint32_t buttons; /* bit k: button k is pressed */
  uint32_t push_count; /* up to 6 */
} fb_probe;

/* What probes did since the last time. @param probes how many there are. Waits for nobody. */
FB_EXPORT fb_status fb_server_ask(fb_server* server, size_t* probes);

/* FB_NOTHING: there are no more. Likewise. */
FB_EXPORT fb_status fb_server_probe(fb_server* server, size_t index, fb_probe* probe);

/* What a probe gave a place that was reported, since it was asked for before. A step of h seconds applies impulse_Ns / h,
 * however long that is ago. Both what the newest report told of and what the one before did may be there. */
typedef struct fb_push {
  size_t size;
  uint32_t body; /* as it was reported */
  uint32_t reserved;
  double place_m[3]; /* likewise */
  double impulse_Ns[3];
} fb_push;

/* @param probe its index @param index below fb_probe.push_count. FB_NOTHING: there are no more. Likewise. */
FB_EXPORT fb_status fb_server_push(fb_server* server, size_t probe, size_t index, fb_push* push);

/* A place that a probe touches, or may before the next report, after the step. Pushed by f it goes on, by z from there:
 *
 *     z'' = W (f + others - k z - c z' + dry friction)
 */
typedef struct fb_touch {
  size_t size;
  uint32_t body; /* as the simulator calls it */
  uint32_t reserved;
  double place_m[3];         /* of the surface, nearest to the probe's centre; within 100 m */
  double normal[3];          /* unit, out of the surface */
  double velocity_m_per_s[3];  /* of the surface there; up to 100 m/s */
  double mobility_per_kg[9];   /* W, symmetric, row by row: J M^-1 J' there; up to 1e4; zero: it stands */
  double others_N[3];          /* on it there now, of all but the probe and c: gravity, its own springs; up to 1e5 N */
  double spring_N_per_m;       /* k, 0 to 1e6, */
  double damper_N_s_per_m;     /* c, 0 to 1e5, and */
  double dry_friction_N;       /* of what it slides on */
  double friction;             /* of the probe along the surface, 0 to 10 */
  double radius_m;             /* the surface goes on so far along its plane from place_m; 0: for ever */
} fb_touch;

/* @param touches may be null if `count` is 0: it meets nothing
 * FB_INVALID: a touch is not what it has to be. FB_NOT_NOW: there is no such client, or it was not asked for. Both are
 * counted (fb_server_state), and what was reported before holds. */
FB_EXPORT fb_status fb_server_report(fb_server* server, uint64_t client, const fb_touch* touches, size_t count);

/* Starts the thread. Once. */
FB_EXPORT fb_status fb_server_start(fb_server* server);

/* Says good-bye to all clients, and waits for the thread. FB_NOT_NOW: it was not started, or a callback of its own asks.
 * FB_FAILED: the thread had failed, and why. Any thread. */
FB_EXPORT fb_status fb_server_stop(fb_server* server);

/* Stops it first; not in a callback. Null is accepted. */
FB_EXPORT void fb_server_destroy(fb_server* server);

/* As of 0.1 s ago at most. */
typedef struct fb_server_state {
  size_t size;
  int32_t running;
  int32_t port;
  char address[FB_TEXT_BYTES]; /* "127.0.0.1:47800" */
  uint64_t clients;            /* now */
  uint64_t clients_refused;
  uint64_t motions;            /* received */
  uint64_t forces;             /* sent, */
  uint64_t forces_zero;        /* of them for want of a sound answer */
  uint64_t callbacks_failed;   /* they said so, or threw */
  uint64_t callbacks_late;     /* took more than 10 ms */
  double busy;                 /* share of its thread's time, of the last second */
  uint64_t reports;            /* of a simulator, accepted */
  uint64_t reports_refused;
  uint64_t silences;           /* times that a probe had no report for 0.25 s */
} fb_server_state;

/* Any thread, at any time. */
FB_EXPORT fb_status fb_server_look(fb_server* server, fb_server_state* state);

/* JSON: the state, and every count that forcebound-server prints at its end. Any time. Arguments as of
 * fb_client_summary. */
FB_EXPORT fb_status fb_server_summary(fb_server* server, char* text, size_t bytes, size_t* needed);

#ifdef __cplusplus
}
namespace forcebound_c {
template <class Struct>
inline Struct initial() {
  Struct made = Struct();
  made.size = sizeof made;
  return made;
}
}
#endif

#endif
