/* A driver of a robot that is simulated (arm_body.h), which is right unless it is told to be wrong:
 *
 *   fault=KIND      one of kFaults, below; those of readings and commands after the 100th reading, in the 100 after it
 *   from=N          after the N-th instead
 *   control=FOLDER  they last while FOLDER has a file `fault` instead. It writes files: `pushed` at the first torque
 *                   that is not zero, `stopped` when it is stopped after that, and `torques` when it is closed: how
 *                   many torques there were after good readings and after bad ones
 *   joints=N        that it says to have
 *   gravity=1       its weight is left to the program
 *   brakes=0        it says to have none
 *   sensor=0        likewise
 *   hold=H          how long it holds a torque [s]
 *   rate=R          that it says its torques may change by at most [N m/s]
 */
#include <forcebound/driver/forcebound_device.h>

#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "arm_body.h"
#include "setting_number.h"

#define GOOD_READINGS 100
#define FAULTS 100
#define NEVER_NS 1000000000000000
#define FOLDER_BYTES 200

struct forcebound_device {
  /* Of these `stop` knows, on whatever thread it is called. */
  arm_body body; /* its flag alone */
  int hangs; /* of "rearms": it was stopped before */
  long torques_after_good;
  /* The rest is the loop's. */
  char fault[24];
  char control[FOLDER_BYTES];
  int joints;
  int gravity;
  int brakes;
  int sensor;
  double hold_s;
  double rate_N_m_per_s;
  int misread; /* the last reading was a bad one */
  long torques_after_bad;
  long readings;
  long good_readings; /* before the faults */
  int64_t sensed_ns;
  pthread_t thread;
  char error[FORCEBOUND_TEXT_BYTES];
};

static const char* const kFaults[] = {
    "none",
    "nan",          /* positions */
    "far",          /* a joint where none can be */
    "backwards",    /* times */
    "future",       /* likewise */
    "fails",        /* readings, with a reason */
    "unplugged",    /* readings and commands */
    "write",        /* commands that fail without a reason */
    "slow",         /* a reading that takes until the fault is over */
    "hang-read",    /* for ever */
    "hang-command", /* likewise */
    "hang-stop",    /* in a reading and in stop */
    "crash",        /* by a bad address, in a reading */
    "crash-command", /* likewise, in a command */
    "crash-thread", /* in a thread of the driver's own */
    "stale",        /* each second reading */
    "jump",         /* of a joint's encoder, by 1 rad */
    "frozen",       /* samples of its sensor */
    "stops",        /* by itself, in a reading */
    "rearms",       /* its first stop is undone, as by a call that was in progress */
    "never-opens",  /* its brakes stay closed */
    "opens-late",   /* after 2.5 s */
    "resume",       /* fails, but opens the brakes */
    "start",        /* does not start */
    "open",         /* does not open */
    "crash-open",   /* crashes there */
    "describe",     /* does not describe itself */
    "undamped",     /* says so */
};

static int is(const forcebound_device* arm, const char* fault) { return strcmp(arm->fault, fault) == 0; }

static int is_known(const char* fault) {
  size_t i;
  for (i = 0; i < sizeof kFaults / sizeof *kFaults; ++i) {
    if (strcmp(kFaults[i], fault) == 0) return 1;
  }
  return 0;
}

static int take(forcebound_device* arm, const char* key, const char* value) {
  if (strcmp(key, "fault") == 0 && is_known(value)) {
    strcpy(arm->fault, value);
  } else if (strcmp(key, "control") == 0 && strlen(value) < sizeof arm->control) {
    strcpy(arm->control, value);
  } else if (strcmp(key, "from") == 0) {
    arm->good_readings = atoi(value);
  } else if (strcmp(key, "joints") == 0) {
    arm->joints = atoi(value);
  } else if (strcmp(key, "gravity") == 0) {
    arm->gravity = atoi(value);
  } else if (strcmp(key, "brakes") == 0) {
    arm->brakes = atoi(value);
  } else if (strcmp(key, "sensor") == 0) {
    arm->sensor = atoi(value);
  } else if (strcmp(key, "hold") == 0) {
    return setting_number(value, &arm->hold_s);
  } else if (strcmp(key, "rate") == 0) {
    return setting_number(value, &arm->rate_N_m_per_s);
  } else {
    return 0;
  }
  return 1;
}

static void crash(void) {
  volatile int* volatile nowhere = NULL;
  *nowhere = 1;
}

static void hang(void) {
  for (;;) pause();
}

static int arm_open(const forcebound_setting* settings, size_t count, forcebound_device** device, char* error,
                    size_t error_bytes) {
  forcebound_device* const arm = calloc(1, sizeof *arm);
  size_t i;
  if (arm == NULL) return FORCEBOUND_FAILED;
  arm->joints = ARM_JOINTS;
  arm->brakes = 1;
  arm->sensor = 1;
  arm->hold_s = 1e-9 * ARM_HOLD_NS;
  arm->good_readings = GOOD_READINGS;
  strcpy(arm->fault, "none");
  for (i = 0; i < count; ++i) {
    if (take(arm, settings[i].key, settings[i].value)) continue;
    snprintf(error, error_bytes, "'%s=%s' is not accepted", settings[i].key, settings[i].value);
    free(arm);
    return FORCEBOUND_FAILED;
  }
  if (is(arm, "crash-open")) crash();
  if (is(arm, "open")) {
    snprintf(error, error_bytes, "no arm at 192.0.2.1: is its power on?");
    free(arm);
    return FORCEBOUND_FAILED;
  }
  arm->body.has_mass = arm->gravity;
  arm_body_reset(&arm->body);
  arm->body.hold_ns = (int64_t)(1e9 * arm->hold_s);
  *device = arm;
  return FORCEBOUND_OK;
}

static void describe_joint(const forcebound_device* arm, forcebound_robot* facts, int i) {
  const double* const next_m = i + 1 < ARM_JOINTS ? kArmPoint_m[i + 1] : kArmTool_m;
  int k;
  for (k = 0; k < 3; ++k) {
    facts->axis[i][k] = kArmAxis[i][k];
    facts->point_m[i][k] = kArmPoint_m[i][k];
    facts->centre_m[i][k] = (kArmPoint_m[i][k] + next_m[k]) / 2;
    facts->inertia_kg_m2[i][k] = 1e-4;
  }
  facts->mass_kg[i] = kArmMass_kg;
  facts->rotor_kg_m2[i] = kArmInertia_kg_m2[i];
  facts->lowest_rad[i] = -2.9;
  facts->highest_rad[i] = 2.9;
  facts->rest_rad[i] = kArmRest_rad[i];
  facts->speed_max[i] = 2;
  facts->torque_max[i] = i < 4 ? 60 : 20;
  facts->torque_rate_max[i] = arm->rate_N_m_per_s;
  facts->damping[i] = is(arm, "undamped") ? 0 : kArmDamping[i];
}

static int arm_describe(forcebound_device* arm, forcebound_robot* facts) {
  int i;
  if (is(arm, "describe")) return FORCEBOUND_FAILED;
  facts->joints = arm->joints;
  snprintf(facts->name, sizeof facts->name, "arm 7");
  facts->identified = 1;
  facts->brakes = arm->brakes;
  facts->gravity = arm->gravity;
  facts->period_s = 1e-3;
  facts->hold_s_max = arm->hold_s;
  for (i = 0; i < ARM_JOINTS; ++i) describe_joint(arm, facts, i);
  for (i = 0; i < 3; ++i) facts->tool_m[i] = kArmTool_m[i];
  facts->tool_speed_m_per_s_max = 1;
  facts->tool_turn_rad_per_s_max = 2;
  if (arm->sensor) facts->sensor_period_s = 1e-3;
  return FORCEBOUND_OK;
}

static int has_file(const forcebound_device* arm, const char* name) {
  char path[FOLDER_BYTES + 16];
  snprintf(path, sizeof path, "%s/%s", arm->control, name);
  return access(path, F_OK) == 0;
}

/* Allocates nothing, as it is called in a tick. */
static void write_numbers(const forcebound_device* arm, const char* name, long first, long second) {
  char path[FOLDER_BYTES + 16];
  char text[48];
  int file = -1;
  if (arm->control[0] == '\0') return;
  snprintf(path, sizeof path, "%s/%s", arm->control, name);
  file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (file < 0) return;
  if (write(file, text, (size_t)snprintf(text, sizeof text, "%ld %ld\n", first, second)) < 0) perror(path);
  close(file);
}

static int misbehaves_now(const forcebound_device* arm) {
  if (arm->control[0] != '\0') return has_file(arm, "fault");
  return arm->readings > arm->good_readings && arm->readings <= arm->good_readings + FAULTS;
}

static void wait_ms(long ms) {
  const struct timespec pause = {0, ms * 1000000};
  nanosleep(&pause, NULL);
}

static void* crash_when_ordered(void* arm) {
  while (!has_file(arm, "fault")) wait_ms(1);
  crash();
  return NULL;
}

static int arm_start(forcebound_device* arm) {
  arm->error[0] = '\0';
  if (is(arm, "start")) {
    snprintf(arm->error, sizeof arm->error, "its emergency stop is pressed");
    return FORCEBOUND_FAILED;
  }
  if (is(arm, "crash-thread")) return pthread_create(&arm->thread, NULL, crash_when_ordered, arm) == 0 ? 0 : 2;
  return FORCEBOUND_OK;
}

static void report(forcebound_device* arm, int64_t now_ns, forcebound_robot_reading* reading) {
  const arm_body* const body = &arm->body;
  int i;
  reading->latched_ns = now_ns;
  for (i = 0; i < ARM_JOINTS; ++i) reading->position_rad[i] = body->position_rad[i];
  reading->has = FORCEBOUND_HAS_EFFECTIVE;
  reading->effective_ns = body->commanded_ns;
  reading->released_ns = body->released_ns;
  if (arm->sensor) reading->has |= FORCEBOUND_HAS_SENSED;
  reading->force_N[2] = -body->floor_N;
  if (!is(arm, "frozen") || !misbehaves_now(arm)) arm->sensed_ns = now_ns;
  reading->sensed_ns = arm->sensed_ns;
  if (!arm->gravity) reading->has |= FORCEBOUND_HAS_ENERGY;
  reading->energy_J = body->energy_J;
  reading->energy_J_least = body->energy_J_least;
  if (arm_body_is_stopped(body)) reading->has |= FORCEBOUND_IS_STOPPED;
}

/* What the faults do that do not return at once. */
static void misbehave_in_read(forcebound_device* arm) {
  if (is(arm, "crash")) crash();
  while (is(arm, "slow") && has_file(arm, "fault")) wait_ms(1);
  if (!is(arm, "hang-read") && !is(arm, "hang-stop")) return;
  __atomic_store_n(&arm->hangs, 1, __ATOMIC_SEQ_CST);
  hang();
}

static int is_bad_reading(const forcebound_device* arm) {
  return is(arm, "nan") || is(arm, "far") || is(arm, "backwards") || is(arm, "future") || is(arm, "fails") ||
         is(arm, "unplugged");
}

static int arm_read(forcebound_device* arm, int64_t now_ns, forcebound_robot_reading* reading) {
  ++arm->readings;
  arm->error[0] = '\0';
  arm_body_pass(&arm->body, now_ns);
  arm->misread = 0;
  if (!misbehaves_now(arm)) {
    report(arm, now_ns, reading);
    return FORCEBOUND_OK;
  }
  misbehave_in_read(arm);
  if (is(arm, "stale") && arm->readings % 2 == 0) return FORCEBOUND_STALE;
  if (is(arm, "stops") && !arm_body_is_stopped(&arm->body)) arm_body_stop(&arm->body);
  report(arm, now_ns, reading);
  arm->misread = is_bad_reading(arm);
  if (is(arm, "nan")) reading->position_rad[1] = NAN;
  if (is(arm, "jump")) reading->position_rad[1] += 1;
  if (is(arm, "far")) reading->position_rad[1] = 4;
  if (is(arm, "backwards")) reading->latched_ns = now_ns - 5000000000;
  if (is(arm, "future")) reading->latched_ns = now_ns + 1000000000;
  if (is(arm, "unplugged")) return FORCEBOUND_UNPLUGGED;
  if (!is(arm, "fails")) return FORCEBOUND_OK;
  snprintf(arm->error, sizeof arm->error, "joint 4 is too hot\n");
  return FORCEBOUND_FAILED;
}

static void count_torque(forcebound_device* arm, const forcebound_robot_command* command) {
  int pushes = 0;
  int i;
  for (i = 0; i < ARM_JOINTS; ++i) pushes = pushes || command->torque_N_m[i] != 0;
  if (!pushes) return;
  if (arm->misread) ++arm->torques_after_bad;
  if (!arm->misread && __atomic_add_fetch(&arm->torques_after_good, 1, __ATOMIC_SEQ_CST) == 1) {
    write_numbers(arm, "pushed", 1, 0);
  }
}

static int arm_command(forcebound_device* arm, const forcebound_robot_command* command) {
  arm->error[0] = '\0';
  count_torque(arm, command);
  if (misbehaves_now(arm)) {
    if (is(arm, "hang-command")) hang();
    if (is(arm, "crash-command")) crash();
    if (is(arm, "unplugged")) return FORCEBOUND_UNPLUGGED;
    if (is(arm, "write")) return FORCEBOUND_FAILED;
  }
  arm_body_command(&arm->body, command->at_ns, command->torque_N_m);
  return FORCEBOUND_OK;
}

static void arm_stop(forcebound_device* arm) {
  if (is(arm, "hang-stop") && __atomic_load_n(&arm->hangs, __ATOMIC_SEQ_CST)) hang();
  if (!is(arm, "rearms") || __atomic_exchange_n(&arm->hangs, 1, __ATOMIC_SEQ_CST)) arm_body_stop(&arm->body);
  if (__atomic_load_n(&arm->torques_after_good, __ATOMIC_SEQ_CST) > 0) write_numbers(arm, "stopped", 1, 0);
}

#ifndef WITHOUT_RESUME
static int arm_resume(forcebound_device* arm) {
  const double none_N_m[ARM_JOINTS] = {0};
  arm_body_command(&arm->body, arm->body.time_ns, none_N_m);
  arm_body_open(&arm->body, is(arm, "opens-late") ? 2500000000 : is(arm, "never-opens") ? NEVER_NS : ARM_OPENS_NS);
  return is(arm, "resume") ? FORCEBOUND_FAILED : FORCEBOUND_OK;
}
#endif

static void arm_close(forcebound_device* arm) {
  write_numbers(arm, "torques", arm->torques_after_good, arm->torques_after_bad);
  free(arm);
}

static const char* arm_last_error(forcebound_device* arm) { return arm->error; }

static const forcebound_driver kArm = {
    .size = sizeof kArm,
    .interface_version = FORCEBOUND_DEVICE_INTERFACE,
    .name = "arm",
    .description = "an arm of seven joints that is simulated, for tests",
    .settings = "  fault=KIND      what is wrong\n"
                "  control=FOLDER  of files that say when\n",
    .open = arm_open,
    .start = arm_start,
    .stop = arm_stop,
    .close = arm_close,
    .last_error = arm_last_error,
    .describe_robot = arm_describe,
    .read_robot = arm_read,
    .command_robot = arm_command,
#ifndef WITHOUT_RESUME
    .resume = arm_resume,
#endif
};

const forcebound_driver* forcebound_driver_entry(uint32_t wanted) {
  (void)wanted;
  return &kArm;
}
