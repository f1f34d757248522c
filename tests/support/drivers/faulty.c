/* A driver of three crossed rails that are simulated, which is right unless it is told to be wrong:
 *
 *   fault=KIND      sign, units, axes, clock, holds, blocks, drift, wraps, nan, crash, stop
 */
#include <forcebound/driver/forcebound_device.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define AXES 3
#define MASS_KG 0.1
#define DAMPING_N_S_PER_M 5.0
#define FORCE_N_MAX 8.0
#define HOLD_NS 10000000
#define FIRST_FAULT 100

struct forcebound_device {
  char fault[16];
  int stopped; /* and given no command since */
  long readings;
  int64_t time_ns;
  int64_t commanded_ns;
  double position_m[AXES];
  double speed_m_per_s[AXES];
  double force_N[AXES];
};

static const char* const kFaults[] = {"none",   "sign",  "units", "axes", "clock", "holds",
                                      "blocks", "drift", "wraps", "nan",  "crash", "stop"};

static int is(const forcebound_device* rails, const char* fault) { return strcmp(rails->fault, fault) == 0; }

static int is_known(const char* fault) {
  size_t i;
  for (i = 0; i < sizeof kFaults / sizeof kFaults[0]; ++i) {
    if (strcmp(kFaults[i], fault) == 0) return 1;
  }
  return 0;
}

static int faulty_open(const forcebound_setting* settings, size_t count, forcebound_device** device, char* error,
                       size_t error_bytes) {
  forcebound_device* const rails = calloc(1, sizeof *rails);
  size_t i;
  if (rails == NULL) return FORCEBOUND_FAILED;
  for (i = 0; i < count; ++i) {
    if (strcmp(settings[i].key, "fault") == 0 && is_known(settings[i].value)) {
      strcpy(rails->fault, settings[i].value);
    } else {
      snprintf(error, error_bytes, "'%s=%s' is not accepted; accepted is fault=KIND", settings[i].key,
               settings[i].value);
      free(rails);
      return FORCEBOUND_FAILED;
    }
  }
  *device = rails;
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

static int faulty_start(forcebound_device* rails) {
  if (!is(rails, "stop")) memset(rails->force_N, 0, sizeof rails->force_N);
  return FORCEBOUND_OK;
}

static double push_N(const forcebound_device* rails, int axis) {
  const int let_go = rails->time_ns - rails->commanded_ns > HOLD_NS && !is(rails, "holds") && !rails->stopped;
  const double drift_N = is(rails, "drift") && axis == 2 ? -0.3 : 0;
  return (let_go ? 0 : rails->force_N[axis]) + drift_N - DAMPING_N_S_PER_M * rails->speed_m_per_s[axis];
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

static int faulty_read(forcebound_device* rails, int64_t now_ns, forcebound_reading* reading) {
  const double scale = is(rails, "units") ? 1000 : 1;
  int i;
  pass(rails, now_ns);
  reading->latched_ns = is(rails, "clock") ? now_ns / 1000000 : now_ns;
  for (i = 0; i < AXES; ++i) reading->position_m[i] = scale * rails->position_m[i];
  if (rails->readings++ < FIRST_FAULT) return FORCEBOUND_OK;
  if (is(rails, "nan")) reading->position_m[1] = strtod("nan", NULL);
  if (is(rails, "crash")) abort();
  return FORCEBOUND_OK;
}

static int faulty_command(forcebound_device* rails, const forcebound_command* command) {
  const struct timespec pause = {0, 2000000};
  int i;
  pass(rails, command->at_ns);
  rails->stopped = 0;
  rails->commanded_ns = command->at_ns;
  for (i = 0; i < AXES; ++i) {
    double force_N = command->force_N[is(rails, "axes") ? (i + 1) % AXES : i];
    if (is(rails, "sign")) force_N = -force_N;
    if (is(rails, "wraps") && fabs(force_N) > FORCE_N_MAX) force_N -= copysign(2 * FORCE_N_MAX, force_N);
    rails->force_N[i] = fmax(-FORCE_N_MAX, fmin(FORCE_N_MAX, force_N));
  }
  if (is(rails, "blocks")) nanosleep(&pause, NULL);
  return FORCEBOUND_OK;
}

static void faulty_stop(forcebound_device* rails) {
  if (!is(rails, "stop")) memset(rails->force_N, 0, sizeof rails->force_N);
  rails->stopped = 1;
}

static void faulty_close(forcebound_device* rails) { free(rails); }

static const char* faulty_last_error(forcebound_device* rails) {
  (void)rails;
  return "";
}

static const forcebound_driver kFaulty = {sizeof kFaulty,
                                          FORCEBOUND_DEVICE_INTERFACE,
                                          "faulty",
                                          "three rails that are simulated, for tests",
                                          "  fault=KIND  what is wrong\n",
                                          faulty_open,
                                          faulty_describe,
                                          faulty_start,
                                          faulty_read,
                                          faulty_command,
                                          faulty_stop,
                                          faulty_close,
                                          faulty_last_error};

const forcebound_driver* forcebound_driver_entry(uint32_t wanted) {
  (void)wanted;
  return &kFaulty;
}
