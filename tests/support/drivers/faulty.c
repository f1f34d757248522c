/* A driver of three crossed rails that are simulated, which is right unless it is told to be wrong:
 *
 *   fault=KIND      one of kFaults, below
 *   control=FOLDER  it is unplugged while FOLDER has a file `unplugged`; its buttons 0 and 1 are pressed while there is
 *                   a file `button-0` or `button-1`; faults that begin with a reading last while there is a file
 *                   `fault`. It writes files: `forced` at its first force, `remembered` at one while it is
 *                   unplugged (remembers), `stopped` when it is stopped after that, and
 *                   `forces` when it is closed: how many forces there were after good readings and after bad ones.
 *                   Without this setting it has no buttons.
 */
#include <forcebound/driver/forcebound_device.h>

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define AXES 3
#define MASS_KG 0.1
#define DAMPING_N_S_PER_M 5.0
#define FORCE_N_MAX 8.0
#define HOLD_NS 10000000
#define FIRST_FAULT 100
#define BUTTONS 2
#define FOLDER_BYTES 200

struct forcebound_device {
  /* Of these `stop` knows, on whatever thread it is called. */
  int stopped; /* and given no command since */
  int hangs;
  long forces_after_good;
  /* The rest is the tick's. */
  char fault[24];
  char control[FOLDER_BYTES];
  int unplugged;
  int misread; /* the last reading was a bad one */
  long forces_after_bad;
  long readings;
  int64_t latched_ns;
  int64_t time_ns;
  int64_t commanded_ns;
  double position_m[AXES];
  double speed_m_per_s[AXES];
  double force_N[AXES];
};

static const char* const kFaults[] = {
    "none",
    "sign",       /* of the force */
    "units",      /* positions in millimetres */
    "axes",       /* forces along the next axis */
    "clock",      /* times in milliseconds */
    "backwards",  /* times that run backwards, in six of seven readings */
    "ahead",      /* times 1 ms in the future */
    "jitter",     /* readings of very different ages */
    "seldom",     /* a new reading in one of five ticks */
    "fails",      /* readings that fail without a reason */
    "write",      /* commands that fail without a reason */
    "holds",      /* a force for ever */
    "blocks",     /* 2 ms in each command */
    "hang-read",  /* for ever, from the 100th reading on */
    "hang-push",  /* for ever, in the first force along y, with the one before it at the motors */
    "hang-stop",  /* likewise, and in stop as well */
    "drift",      /* at zero force */
    "wraps",      /* forces beyond the largest one */
    "nan",        /* positions */
    "crash",      /* abort, in the 100th reading */
    "crash-push", /* by a bad address, in the first force along y */
    "exit",       /* ends the process, in the first force along y */
    "crash-thread", /* by a bad address, in a thread of its own, once there is a file `fault` */
    "overflow",     /* recursion without an end, in the 100th reading */
    "crash-reopen", /* by a bad address, when it is opened a second time */
    "crash-start",  /* likewise, when it is started */
    "crash-stop",   /* likewise, when it is stopped after a force */
    "crash-close",  /* likewise, closed */
    "stop",       /* does not end the force */
    "settings",   /* accepts all */
    "remembers",  /* applies the last force when it is plugged in again */
};

static void crash(void) {
  volatile int* volatile nowhere = NULL;
  *nowhere = 1;
}

static int recurse(volatile int depth) {
  volatile char room[4096];
  if (depth < 0) return 0;
  room[depth % 4096] = (char)depth;
  return recurse(depth + 1) + room[0];
}

static int of_any_thread(const int* number) { return __atomic_load_n(number, __ATOMIC_SEQ_CST); }
static void set_for_any_thread(int* number, int value) { __atomic_store_n(number, value, __ATOMIC_SEQ_CST); }

static int is(const forcebound_device* rails, const char* fault) { return strcmp(rails->fault, fault) == 0; }

static int is_known(const char* fault) {
  size_t i;
  for (i = 0; i < sizeof kFaults / sizeof kFaults[0]; ++i) {
    if (strcmp(kFaults[i], fault) == 0) return 1;
  }
  return 0;
}

static int accepts(forcebound_device* rails, const forcebound_setting* setting) {
  if (strcmp(setting->key, "fault") == 0 && is_known(setting->value)) {
    strcpy(rails->fault, setting->value);
    return 1;
  }
  if (strcmp(setting->key, "control") == 0 && strlen(setting->value) < sizeof rails->control) {
    strcpy(rails->control, setting->value);
    return 1;
  }
  return is(rails, "settings");
}

static int has_file(const forcebound_device* rails, const char* name) {
  char path[FOLDER_BYTES + 16];
  if (rails->control[0] == '\0') return 0;
  snprintf(path, sizeof path, "%s/%s", rails->control, name);
  return access(path, F_OK) == 0;
}

static void write_numbers(const forcebound_device* rails, const char* name, long first, long second) {
  char path[FOLDER_BYTES + 16];
  FILE* file = NULL;
  if (rails->control[0] == '\0') return;
  snprintf(path, sizeof path, "%s/%s", rails->control, name);
  file = fopen(path, "w");
  if (file == NULL) return;
  fprintf(file, "%ld %ld\n", first, second);
  fclose(file);
}

static int faulty_open(const forcebound_setting* settings, size_t count, forcebound_device** device, char* error,
                       size_t error_bytes) {
  forcebound_device* const rails = calloc(1, sizeof *rails);
  size_t i;
  if (rails == NULL) return FORCEBOUND_FAILED;
  for (i = 0; i < count; ++i) {
    if (accepts(rails, &settings[i])) continue;
    snprintf(error, error_bytes, "'%s=%s' is not accepted; accepted are fault=KIND and control=FOLDER", settings[i].key,
             settings[i].value);
    free(rails);
    return FORCEBOUND_FAILED;
  }
  *device = rails;
  if (is(rails, "crash-reopen") && has_file(rails, "opened")) crash();
  write_numbers(rails, "opened", 1, 0);
  return FORCEBOUND_OK;
}

static int faulty_describe(forcebound_device* rails, forcebound_facts* facts) {
  int i;
  (void)rails;
  facts->degrees_of_freedom = AXES;
  snprintf(facts->name, sizeof facts->name, "three rails");
  facts->identified = 1;
  facts->period_s = 1e-3;
  for (i = 0; i < AXES; ++i) facts->damping[i * AXES + i] = DAMPING_N_S_PER_M;
  facts->force_N_max = FORCE_N_MAX;
  facts->hold_s_max = 1e-9 * HOLD_NS;
  return FORCEBOUND_OK;
}

static void* crash_when_ordered(void* rails) {
  const struct timespec look = {0, 1000000};
  while (!has_file(rails, "fault")) nanosleep(&look, NULL);
  crash();
  return NULL;
}

static int faulty_start(forcebound_device* rails) {
  pthread_t thread;
  if (is(rails, "crash-start")) crash();
  if (is(rails, "crash-thread") && pthread_create(&thread, NULL, crash_when_ordered, rails) != 0) return FORCEBOUND_FAILED;
  if (!is(rails, "stop")) memset(rails->force_N, 0, sizeof rails->force_N);
  return FORCEBOUND_OK;
}

static double push_N(const forcebound_device* rails, int axis) {
  const int stopped = of_any_thread(&rails->stopped);
  const int late = rails->time_ns - rails->commanded_ns > HOLD_NS && !stopped;
  const int lets_go = late && !is(rails, "holds") && !is(rails, "remembers");
  const int ended = lets_go || rails->unplugged || (stopped && !is(rails, "stop"));
  const double drift_N = is(rails, "drift") && axis == 2 ? -0.3 : 0;
  return (ended ? 0 : rails->force_N[axis]) + drift_N - DAMPING_N_S_PER_M * rails->speed_m_per_s[axis];
}

static void pass(forcebound_device* rails, int64_t now_ns) {
  const int64_t step_ns = 20000;
  if (rails->time_ns == 0) rails->time_ns = now_ns;
  for (; rails->time_ns < now_ns; rails->time_ns += step_ns) {
    int i;
    for (i = 0; i < AXES; ++i) {
      rails->speed_m_per_s[i] += 1e-9 * (double)step_ns * push_N(rails, i) / MASS_KG;
      rails->position_m[i] += 1e-9 * (double)step_ns * rails->speed_m_per_s[i];
    }
  }
}

static int misbehaves_now(const forcebound_device* rails) {
  return rails->control[0] == '\0' ? rails->readings > FIRST_FAULT : has_file(rails, "fault");
}

/* What a person does to it. */
static void look_at_person(forcebound_device* rails, forcebound_reading* reading) {
  static const char* const kButtons[BUTTONS] = {"button-0", "button-1"};
  unsigned i;
  rails->unplugged = has_file(rails, "unplugged");
  if (rails->unplugged && !is(rails, "remembers")) memset(rails->force_N, 0, sizeof rails->force_N);
  if (rails->control[0] == '\0') return;
  reading->has |= FORCEBOUND_HAS_BUTTONS;
  for (i = 0; i < BUTTONS; ++i) {
    if (has_file(rails, kButtons[i])) reading->buttons |= 1u << i;
  }
}

static int64_t later(int64_t first_ns, int64_t second_ns) { return first_ns > second_ns ? first_ns : second_ns; }

static int64_t latched_ns(const forcebound_device* rails, int64_t now_ns) {
  const int64_t ms = 1000000;
  if (is(rails, "clock")) return now_ns / ms;
  if (is(rails, "jitter")) return later(now_ns - rails->readings % 10 * ms / 2, rails->latched_ns + 1);
  if (is(rails, "seldom") && rails->readings % 5 != 0) return rails->latched_ns;
  if (is(rails, "backwards") && misbehaves_now(rails) && (rails->control[0] != '\0' || rails->readings % 7 != 0))
    return now_ns - 5000 * ms;
  if (is(rails, "ahead") && misbehaves_now(rails)) return now_ns + ms;
  return now_ns;
}

static void hang(void) {
  for (;;) pause();
}

static int faulty_read(forcebound_device* rails, int64_t now_ns, forcebound_reading* reading) {
  const double scale = is(rails, "units") ? 1000 : 1;
  int i;
  pass(rails, now_ns);
  look_at_person(rails, reading);
  rails->misread = rails->unplugged;
  if (rails->unplugged) return FORCEBOUND_UNPLUGGED;
  ++rails->readings;
  rails->latched_ns = reading->latched_ns = latched_ns(rails, now_ns);
  for (i = 0; i < AXES; ++i) reading->position_m[i] = scale * rails->position_m[i];
  rails->misread = reading->latched_ns != now_ns;
  if (!misbehaves_now(rails)) return FORCEBOUND_OK;
  if (is(rails, "crash")) abort();
  if (is(rails, "overflow")) (void)recurse(0);
  if (is(rails, "hang-read")) hang();
  rails->misread = rails->misread || is(rails, "nan") || is(rails, "fails");
  if (is(rails, "nan")) reading->position_m[1] = strtod("nan", NULL);
  return is(rails, "fails") ? FORCEBOUND_FAILED : FORCEBOUND_OK;
}

static int pushes(const forcebound_command* command) {
  int i;
  for (i = 0; i < AXES; ++i) {
    if (command->force_N[i] != 0) return 1;
  }
  return 0;
}

static void count_force(forcebound_device* rails) {
  if (rails->misread) {
    ++rails->forces_after_bad;
  } else if (__atomic_add_fetch(&rails->forces_after_good, 1, __ATOMIC_SEQ_CST) == 1) {
    write_numbers(rails, "forced", 1, 0);
  }
}

static void misbehave_in_push(forcebound_device* rails) {
  const int hangs = is(rails, "hang-push") || is(rails, "hang-stop");
  set_for_any_thread(&rails->hangs, hangs);
  if (hangs) hang();
  if (is(rails, "crash-push")) crash();
  if (is(rails, "exit")) exit(0);
}

static int faulty_command(forcebound_device* rails, const forcebound_command* command) {
  const struct timespec pause_2_ms = {0, 2000000};
  int i;
  pass(rails, command->at_ns);
  if (pushes(command)) count_force(rails);
  if (rails->control[0] == '\0' ? command->force_N[1] != 0 : misbehaves_now(rails)) misbehave_in_push(rails);
  if (rails->unplugged && !is(rails, "remembers")) return FORCEBOUND_UNPLUGGED;
  if (rails->unplugged && pushes(command)) write_numbers(rails, "remembered", 1, 0);
  set_for_any_thread(&rails->stopped, 0);
  rails->commanded_ns = command->at_ns;
  for (i = 0; i < AXES; ++i) {
    double force_N = command->force_N[is(rails, "axes") ? (i + 1) % AXES : i];
    if (is(rails, "sign")) force_N = -force_N;
    if (is(rails, "wraps") && fabs(force_N) > FORCE_N_MAX) force_N -= copysign(2 * FORCE_N_MAX, force_N);
    rails->force_N[i] = fmax(-FORCE_N_MAX, fmin(FORCE_N_MAX, force_N));
  }
  if (is(rails, "blocks")) nanosleep(&pause_2_ms, NULL);
  return is(rails, "write") ? FORCEBOUND_FAILED : FORCEBOUND_OK;
}

static void faulty_stop(forcebound_device* rails) {
  if (is(rails, "hang-stop") && of_any_thread(&rails->hangs)) hang();
  set_for_any_thread(&rails->stopped, 1);
  if (__atomic_load_n(&rails->forces_after_good, __ATOMIC_SEQ_CST) == 0) return;
  if (is(rails, "crash-stop")) crash();
  write_numbers(rails, "stopped", 1, 0);
}

static void faulty_close(forcebound_device* rails) {
  if (is(rails, "crash-close") && rails->forces_after_good > 0) crash();
  write_numbers(rails, "forces", rails->forces_after_good, rails->forces_after_bad);
  free(rails);
}

static const char* faulty_last_error(forcebound_device* rails) {
  (void)rails;
  return "";
}

static const forcebound_driver kFaulty = {
    .size = sizeof kFaulty,
    .interface_version = FORCEBOUND_DEVICE_INTERFACE,
    .name = "faulty",
    .description = "three rails that are simulated, for tests",
    .settings = "  fault=KIND      what is wrong\n"
                "  control=FOLDER  of files that say what a person does to it\n",
    .open = faulty_open,
    .describe = faulty_describe,
    .start = faulty_start,
    .read = faulty_read,
    .command = faulty_command,
    .stop = faulty_stop,
    .close = faulty_close,
    .last_error = faulty_last_error,
};

const forcebound_driver* forcebound_driver_entry(uint32_t wanted) {
  (void)wanted;
  return &kFaulty;
}
