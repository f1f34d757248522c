/* A driver of a slider that is simulated: a mass on a rail with viscous friction, read and pushed as real ones are. It
 * lets go of a force after 10 ms without a command.
 *
 *   axes=N          1 to 3, each the same; 1 unless said
 *   fault=KIND      from the 100th reading on: nan, backwards, future, stale, fails, unplugged (for 100 readings);
 *                   locale: it takes the environment's for all of the process, at once;
 *                   handle: an orientation and a gripper, which cannot be true from then on
 */
#include <forcebound/driver/forcebound_device.h>

#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MASS_KG 0.1
#define DAMPING_N_S_PER_M 5.0
#define HOLD_NS 10000000
#define FIRST_FAULT 100
#define FAULTS 100

struct forcebound_device {
  int stopped; /* and given no command since; set on whatever thread `stop` is called on */
  int axes;
  char fault[16];
  int started;
  long readings;
  int64_t time_ns;
  int64_t commanded_ns;
  double position_m[3];
  double speed_m_per_s[3];
  double force_N[3];
  char error[FORCEBOUND_TEXT_BYTES];
};

static int slider_open(const forcebound_setting* settings, size_t count, forcebound_device** device, char* error,
                       size_t error_bytes) {
  forcebound_device* const slider = calloc(1, sizeof *slider);
  size_t i;
  if (slider == NULL) return FORCEBOUND_FAILED;
  slider->axes = 1;
  for (i = 0; i < count; ++i) {
    if (strcmp(settings[i].key, "axes") == 0 && atoi(settings[i].value) >= 1 && atoi(settings[i].value) <= 3) {
      slider->axes = atoi(settings[i].value);
    } else if (strcmp(settings[i].key, "fault") == 0 && strlen(settings[i].value) < sizeof slider->fault) {
      strcpy(slider->fault, settings[i].value);
    } else {
      snprintf(error, error_bytes, "'%s=%s' is not accepted; accepted are axes=1 to 3 and fault=KIND", settings[i].key,
               settings[i].value);
      free(slider);
      return FORCEBOUND_FAILED;
    }
  }
  *device = slider;
  return FORCEBOUND_OK;
}

static int slider_describe(forcebound_device* slider, forcebound_facts* facts) {
  int i;
  facts->degrees_of_freedom = slider->axes;
  snprintf(facts->name, sizeof facts->name, "slider 7");
  facts->identified = strcmp(slider->fault, "guessed") != 0;
  facts->period_s = 1e-3;
  for (i = 0; i < slider->axes; ++i) {
    facts->damping[i * slider->axes + i] = strcmp(slider->fault, "undamped") == 0 ? 0 : DAMPING_N_S_PER_M;
    facts->encoder_step[i] = 0;
  }
  facts->force_N_max = 8;
  facts->hold_s_max = 1e-9 * HOLD_NS;
  if (strcmp(slider->fault, "warm") == 0) facts->force_N_continuous = 0.5;
  return FORCEBOUND_OK;
}

static int slider_start(forcebound_device* slider) {
  if (strcmp(slider->fault, "start") == 0) {
    snprintf(slider->error, sizeof slider->error, "no power");
    return FORCEBOUND_FAILED;
  }
  if (strcmp(slider->fault, "locale") == 0) setlocale(LC_ALL, "");
  slider->started = 1;
  return FORCEBOUND_OK;
}

static void pass(forcebound_device* slider, int64_t now_ns) {
  const int64_t step_ns = 10000;
  const double step_s = 1e-9 * (double)step_ns;
  const int stopped = __atomic_load_n(&slider->stopped, __ATOMIC_SEQ_CST);
  if (slider->time_ns == 0) slider->time_ns = now_ns;
  for (; slider->time_ns < now_ns; slider->time_ns += step_ns) {
    const int held = slider->time_ns - slider->commanded_ns <= HOLD_NS && !stopped;
    int i;
    for (i = 0; i < slider->axes; ++i) {
      const double push_N = (held ? slider->force_N[i] : 0) - DAMPING_N_S_PER_M * slider->speed_m_per_s[i];
      slider->speed_m_per_s[i] += step_s * push_N / MASS_KG;
      slider->position_m[i] += step_s * slider->speed_m_per_s[i];
    }
  }
}

static int slider_read(forcebound_device* slider, int64_t now_ns, forcebound_reading* reading) {
  const long number = slider->readings++;
  const int faulty = number >= FIRST_FAULT && number < FIRST_FAULT + FAULTS;
  int i;
  pass(slider, now_ns);
  reading->latched_ns = now_ns;
  for (i = 0; i < slider->axes; ++i) reading->position_m[i] = slider->position_m[i];
  reading->has = FORCEBOUND_HAS_EFFECTIVE | FORCEBOUND_HAS_BUTTONS;
  reading->buttons = 2;
  reading->effective_ns = slider->commanded_ns;
  if (slider->commanded_ns > 0 && now_ns - slider->commanded_ns > HOLD_NS)
    reading->released_ns = slider->commanded_ns + HOLD_NS;
  if (strcmp(slider->fault, "handle") == 0) {
    reading->has |= FORCEBOUND_HAS_ORIENTATION | FORCEBOUND_HAS_GRIPPER;
    reading->orientation[3] = faulty ? 2 : 1.005;
    reading->gripper = faulty ? strtod("nan", NULL) : 1.005;
  }
  slider->error[0] = '\0';
  if (!faulty) return FORCEBOUND_OK;
  if (strcmp(slider->fault, "nan") == 0) reading->position_m[0] = strtod("nan", NULL);
  if (strcmp(slider->fault, "backwards") == 0) reading->latched_ns = now_ns - 5000000000;
  if (strcmp(slider->fault, "future") == 0) reading->latched_ns = now_ns + 1000000000;
  if (strcmp(slider->fault, "stale") == 0) return FORCEBOUND_STALE;
  if (strcmp(slider->fault, "fails") == 0) {
    snprintf(slider->error, sizeof slider->error, "the bus is busy\n");
    return FORCEBOUND_FAILED;
  }
  if (strcmp(slider->fault, "unplugged") == 0) return FORCEBOUND_UNPLUGGED;
  return FORCEBOUND_OK;
}

static int slider_command(forcebound_device* slider, const forcebound_command* command) {
  int i;
  pass(slider, command->at_ns);
  __atomic_store_n(&slider->stopped, 0, __ATOMIC_SEQ_CST);
  slider->commanded_ns = command->at_ns;
  for (i = 0; i < slider->axes; ++i) slider->force_N[i] = command->force_N[i];
  return strcmp(slider->fault, "write") == 0 ? FORCEBOUND_FAILED : FORCEBOUND_OK;
}

static void slider_stop(forcebound_device* slider) { __atomic_store_n(&slider->stopped, 1, __ATOMIC_SEQ_CST); }

static void slider_close(forcebound_device* slider) { free(slider); }

static const char* slider_last_error(forcebound_device* slider) { return slider->error; }

static const forcebound_driver kSlider = {
    .size = sizeof kSlider,
    .interface_version = FORCEBOUND_DEVICE_INTERFACE,
    .name = "slider",
    .description = "a slider that is simulated, for tests",
    .settings = "  axes=N      1 to 3\n",
    .open = slider_open,
    .describe = slider_describe,
    .start = slider_start,
    .read = slider_read,
    .command = slider_command,
    .stop = slider_stop,
    .close = slider_close,
    .last_error = slider_last_error,
};

const forcebound_driver* forcebound_driver_entry(uint32_t wanted) {
  (void)wanted;
  return &kSlider;
}
