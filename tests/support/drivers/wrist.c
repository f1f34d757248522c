/* A driver of a device of six axes that is simulated: a gantry of three sliding axes that carries a gimbal of three
 * turning ones, which meet in the handle. Each axis has a motor, mass and viscous friction.
 *
 *   fault=orientation   readings without one
 */
#include <forcebound/driver/forcebound_device.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define AXES 6
#define HOLD_NS 10000000

static const double kInertia[AXES] = {0.2, 0.2, 0.2, 2e-4, 2e-4, 2e-4};
static const double kDamping[AXES] = {5, 5, 5, 0.003, 0.003, 0.003};

struct forcebound_device {
  int stopped;
  int tells_orientation;
  int64_t time_ns;
  int64_t commanded_ns;
  double joint[AXES];
  double speed[AXES];
  double effort[AXES]; /* of the motors [N], [N m] */
};

static int wrist_open(const forcebound_setting* settings, size_t count, forcebound_device** device, char* error,
                      size_t error_bytes) {
  forcebound_device* const wrist = calloc(1, sizeof *wrist);
  if (wrist == NULL) return FORCEBOUND_FAILED;
  wrist->tells_orientation = 1;
  if (count == 1 && strcmp(settings[0].key, "fault") == 0 && strcmp(settings[0].value, "orientation") == 0) {
    wrist->tells_orientation = 0;
  } else if (count > 0) {
    snprintf(error, error_bytes, "accepted is fault=orientation");
    free(wrist);
    return FORCEBOUND_FAILED;
  }
  *device = wrist;
  return FORCEBOUND_OK;
}

static int wrist_describe(forcebound_device* wrist, forcebound_facts* facts) {
  int i;
  (void)wrist;
  snprintf(facts->name, sizeof facts->name, "wrist 6");
  facts->degrees_of_freedom = AXES;
  facts->in_joints = 1;
  facts->period_s = 1e-3;
  for (i = 0; i < AXES; ++i) facts->damping[i * AXES + i] = kDamping[i];
  facts->force_N_max = 8;
  facts->hold_s_max = 1e-9 * HOLD_NS;
  return FORCEBOUND_OK;
}

static int wrist_start(forcebound_device* wrist) {
  (void)wrist;
  return FORCEBOUND_OK;
}

static void pass(forcebound_device* wrist, int64_t now_ns) {
  const int64_t step_ns = 10000;
  const double step_s = 1e-9 * (double)step_ns;
  if (wrist->time_ns == 0) wrist->time_ns = now_ns;
  for (; wrist->time_ns < now_ns; wrist->time_ns += step_ns) {
    const int stopped = __atomic_load_n(&wrist->stopped, __ATOMIC_SEQ_CST);
    const int held = wrist->time_ns - wrist->commanded_ns <= HOLD_NS && !stopped;
    int i;
    for (i = 0; i < AXES; ++i) {
      wrist->speed[i] += step_s * ((held ? wrist->effort[i] : 0) - kDamping[i] * wrist->speed[i]) / kInertia[i];
      wrist->joint[i] += step_s * wrist->speed[i];
    }
  }
}

/* Axes of the gimbal in the scene's frame: x, then y turned by the first angle, then z turned by both. */
static void axes_of(const forcebound_device* wrist, double axes[3][3]) {
  const double a = wrist->joint[3], b = wrist->joint[4];
  axes[0][0] = 1, axes[0][1] = 0, axes[0][2] = 0;
  axes[1][0] = 0, axes[1][1] = cos(a), axes[1][2] = sin(a);
  axes[2][0] = sin(b), axes[2][1] = -sin(a) * cos(b), axes[2][2] = cos(a) * cos(b);
}

/* to = to * (a turn about x, y or z) */
static void turn(double to[4], int axis, double angle) {
  const double c = cos(angle / 2), s = sin(angle / 2);
  const double q[4] = {c, axis == 0 ? s : 0, axis == 1 ? s : 0, axis == 2 ? s : 0};
  const double w = to[0], x = to[1], y = to[2], z = to[3];
  to[0] = w * q[0] - x * q[1] - y * q[2] - z * q[3];
  to[1] = w * q[1] + x * q[0] + y * q[3] - z * q[2];
  to[2] = w * q[2] - x * q[3] + y * q[0] + z * q[1];
  to[3] = w * q[3] + x * q[2] - y * q[1] + z * q[0];
}

static int wrist_read(forcebound_device* wrist, int64_t now_ns, forcebound_reading* reading) {
  double axes[3][3];
  int i, row;
  pass(wrist, now_ns);
  reading->latched_ns = now_ns;
  axes_of(wrist, axes);
  for (i = 0; i < AXES; ++i) reading->joint[i] = wrist->joint[i];
  for (i = 0; i < 3; ++i) {
    reading->position_m[i] = wrist->joint[i];
    reading->jacobian[AXES * i + i] = 1;
    for (row = 0; row < 3; ++row) reading->jacobian[AXES * (3 + row) + 3 + i] = axes[i][row];
  }
  if (!wrist->tells_orientation) return FORCEBOUND_OK;
  reading->has = FORCEBOUND_HAS_ORIENTATION;
  reading->orientation[0] = 1;
  for (i = 0; i < 3; ++i) turn(reading->orientation, i, wrist->joint[3 + i]);
  return FORCEBOUND_OK;
}

static int wrist_command(forcebound_device* wrist, const forcebound_command* command) {
  double axes[3][3];
  int i;
  pass(wrist, command->at_ns);
  axes_of(wrist, axes);
  __atomic_store_n(&wrist->stopped, 0, __ATOMIC_SEQ_CST);
  wrist->commanded_ns = command->at_ns;
  for (i = 0; i < 3; ++i) {
    wrist->effort[i] = command->force_N[i];
    wrist->effort[3 + i] = axes[i][0] * command->torque_N_m[0] + axes[i][1] * command->torque_N_m[1] +
                           axes[i][2] * command->torque_N_m[2];
  }
  return FORCEBOUND_OK;
}

static void wrist_stop(forcebound_device* wrist) { __atomic_store_n(&wrist->stopped, 1, __ATOMIC_SEQ_CST); }

static void wrist_close(forcebound_device* wrist) { free(wrist); }

static const char* wrist_last_error(forcebound_device* wrist) {
  (void)wrist;
  return "";
}

static const forcebound_driver kWrist = {
    .size = sizeof kWrist,
    .interface_version = FORCEBOUND_DEVICE_INTERFACE,
    .name = "wrist",
    .description = "six axes that are simulated, for tests",
    .settings = "  fault=orientation\n",
    .open = wrist_open,
    .describe = wrist_describe,
    .start = wrist_start,
    .read = wrist_read,
    .command = wrist_command,
    .stop = wrist_stop,
    .close = wrist_close,
    .last_error = wrist_last_error,
};

const forcebound_driver* forcebound_driver_entry(uint32_t wanted) {
  (void)wanted;
  return &kWrist;
}
