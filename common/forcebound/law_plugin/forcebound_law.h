/* The C interface of laws: what a law of one's own implements, and what Forcebound may rely on.
 *
 * A law is a shared library that exports one function, forcebound_law_entry. It is found by its path, `--law ./mine.so`,
 * or as `--law NAME`: forcebound-law-NAME.so in the folders of FORCEBOUND_LAW_PATH (colons between them), then in the
 * folder lib/forcebound/laws beside the programs' own. It needs nothing but this header (C99 or C++).
 *
 * Units and frames: SI; metres, newtons, seconds, radians. Positions and forces are those of the tip in the device's
 * frame. A force is what the device does to the hand: a wall at x >= 0 asks for f = -K x. Where the tip turns, the last
 * three rows of a force are a torque [N m], those of a position the sum of the rotation vectors of all intervals [rad].
 *
 * Threads: each law that `create` made is used by one thread at a time. Several may run at once, each on a thread.
 *
 * Time limits: tick allocates nothing, locks nothing, and returns within some microseconds. A force that takes effect
 * later than the reading's latency_s_max, at most half a period, is replaced by zero, and counted (withdrawn_forces).
 * create may take 1 s.
 *
 * Faults: a tick that fails, throws, or gives a force that is not finite is zero force, and counted (law_faults). A force
 * longer than the device can be asked for is shortened, and what remains is rounded as the motors are: `held_N` of the
 * next reading says what became of it.
 *
 * Versions: a struct begins with its size as its maker knows it. Fields are only ever added at the end; who reads a
 * struct reads no further than its size, and takes what lies beyond as zero. So a law built against an older header goes
 * on working. FORCEBOUND_LAW_INTERFACE changes only if that is not possible.
 */
#ifndef FORCEBOUND_LAW_H
#define FORCEBOUND_LAW_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FORCEBOUND_LAW_INTERFACE 1u
#define FORCEBOUND_LAW_AXES_MAX 6
#define FORCEBOUND_LAW_JOINTS_MAX 8
#define FORCEBOUND_LAW_TEXT_BYTES 256

/* What a function of a law returns. */
enum { FORCEBOUND_LAW_OK = 0, FORCEBOUND_LAW_FAILED = 1 };

/* What a law promises of P, whatever environment and network do: control/law_description.hpp. Audited, never believed. */
enum {
  FORCEBOUND_LAW_PROMISES_NOTHING = 0,
  FORCEBOUND_LAW_PASSIVE_IF_IDEAL = 1, /* straight axes, ideal encoders, punctual ticks, forces in effect at the reading */
  FORCEBOUND_LAW_PASSIVE = 2           /* on each device that keeps to its facts */
};

/* A number that can be chosen: --law-parameters, and what `forcebound-lab compare` searches for. Never grows. */
typedef struct forcebound_law_parameter {
  const char* name;    /* with its unit: "reserve_J" */
  const char* purpose; /* a line for --law-help */
  double least;        /* accepted from here */
  double most;         /* to here, where compare looks from an eighth to eight times `standard` */
  double standard;     /* unless chosen */
} forcebound_law_parameter;

/* What is known of the device: bounds that hold over its whole workspace. Arrays have `joints` entries, damping as many
 * rows of as many; of joints that turn, [N m s/rad], [N m], [rad]. */
typedef struct forcebound_law_facts {
  uint32_t size;
  int32_t degrees_of_freedom; /* rows of positions and forces, 1 to 6 */
  int32_t rotations;          /* 3: the last three of these are rotations; 0: none is */
  int32_t joints;
  int32_t cartesian;   /* 1: the joints are the tip's axes, and the Jacobian is the identity */
  int32_t full_memory; /* 1: --memory full, all energy may be kept for later; 0: what the largest force can need */
  char name[FORCEBOUND_LAW_TEXT_BYTES];
  double period_s; /* nominal */
  double damping[FORCEBOUND_LAW_JOINTS_MAX * FORCEBOUND_LAW_JOINTS_MAX]; /* lower bound, row by row (row k begins at
                                                                            k * joints), positive definite [N s/m] */
  double friction[FORCEBOUND_LAW_JOINTS_MAX];      /* lower bound of the Coulomb friction [N] */
  double encoder_step[FORCEBOUND_LAW_JOINTS_MAX];  /* distance of two neighbouring readings [m]; 0: ideal */
  double actuator_step[FORCEBOUND_LAW_JOINTS_MAX]; /* distance of two neighbouring forces [N]; 0: ideal */
  double speed_max[FORCEBOUND_LAW_JOINTS_MAX];     /* no joint is ever faster [m/s]; 0: not known */
  double force_N_max;    /* largest that is asked of the device: the length of the vector */
  double torque_N_m_max; /* likewise, where there are rotations */
  double hold_s_max;     /* the device releases a force so long after it took effect; 0: never */
  double latency_s;      /* from command to force at the motors */
} forcebound_law_facts;

/* Bits of forcebound_law_reading.has */
#define FORCEBOUND_LAW_LOST 1u         /* there was no reading: only times and held_N are told, the force is not used */
#define FORCEBOUND_LAW_WRITE_FAILED 2u /* whether held_N was in effect at all, or the force before it, is not known */

/* What a tick measured. The interval is the one that ends with it, under the force held_N. */
typedef struct forcebound_law_reading {
  uint32_t size;
  uint32_t has;
  double interval_s;    /* measured; 0 at first */
  double latency_s;     /* from the previous reading to the effect of held_N, by the facts */
  double effect_s;      /* the same as the device reports it; NaN: it does not */
  double held_s;        /* from latency_s until the device let go of held_N; infinite: it did not */
  double latency_s_max; /* longest time from this reading to the effect of the force that is now asked for */
  double position[FORCEBOUND_LAW_AXES_MAX];
  double joint[FORCEBOUND_LAW_JOINTS_MAX]; /* where cartesian the position */
  double jacobian[FORCEBOUND_LAW_AXES_MAX * FORCEBOUND_LAW_JOINTS_MAX]; /* d position / d joint; row k begins at
                                                                           k * joints */
  double damping[FORCEBOUND_LAW_AXES_MAX * FORCEBOUND_LAW_AXES_MAX];    /* lower bound at the tip in the interval that
                                                                           begins here [N s/m]; row k begins at
                                                                           k * degrees_of_freedom */
  double held_N[FORCEBOUND_LAW_AXES_MAX]; /* what became of the force of the tick before */
} forcebound_law_reading;

/* What the environment asks for; zero where it has not answered. Finite, no longer than the device can be asked for. */
typedef struct forcebound_law_request {
  uint32_t size;
  uint32_t reserved;
  double force_N[FORCEBOUND_LAW_AXES_MAX];
} forcebound_law_request;

/* Forcebound sets `size` and zeros the rest before it calls tick. */
typedef struct forcebound_law_force {
  uint32_t size;
  uint32_t reserved;
  double force_N[FORCEBOUND_LAW_AXES_MAX];
  double energy_J; /* that the law may spend now, for tables and pages */
} forcebound_law_force;

/* A law at work; only its library knows what is in it. */
typedef struct forcebound_law forcebound_law;

/* name, create, tick and destroy must be there. */
typedef struct forcebound_law_functions {
  uint32_t size;
  uint32_t interface_version; /* FORCEBOUND_LAW_INTERFACE of the header that the law was built with */
  const char* name;           /* as tables and recordings call it: small letters, digits and '-'; not that of another law */
  const char* summary;        /* a line */
  const char* reference;      /* who, when; null: its maker's own */
  int32_t promise;
  int32_t shortens; /* 1: its force is never but the request, made shorter at most */
  const forcebound_law_parameter* parameters;
  size_t parameter_count;

  /* A law at rest, for a device. @param parameters a number for each parameter. On failure `error` gets one line: what
   * about the device or the parameters it cannot work with. */
  int (*create)(const forcebound_law_facts* facts, const double* parameters, forcebound_law** law, char* error,
                size_t error_bytes);
  /* Once for each reading: counts what happened since the last, and chooses the force. */
  int (*tick)(forcebound_law* law, const forcebound_law_reading* reading, const forcebound_law_request* request,
              forcebound_law_force* force);
  void (*destroy)(forcebound_law* law);
} forcebound_law_functions;

/* The one function that a law exports. `wanted` is the interface of the program; a law that cannot serve it returns its
 * own table all the same, of which only size and interface_version are read then. The table stays valid. */
#if defined(__GNUC__)
#define FORCEBOUND_LAW_EXPORT __attribute__((visibility("default")))
#else
#define FORCEBOUND_LAW_EXPORT
#endif
FORCEBOUND_LAW_EXPORT const forcebound_law_functions* forcebound_law_entry(uint32_t wanted);

#ifdef __cplusplus
}
#endif

#endif
