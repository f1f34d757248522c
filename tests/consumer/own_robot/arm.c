/* A driver of an invented arm of three joints, complete. The hardware is a few numbers in memory: each joint is a
 * flywheel with damping. A real one has a thread that talks to the robot, and shares the newest numbers with these
 * functions; see forcebound_device.h for what each may do and how long it may take.
 *
 *   cc -shared -fPIC -I PREFIX/include arm.c -o arm.so
 *   forcebound-server --follower driver:./arm.so --architecture position-position */
#include <forcebound/driver/forcebound_device.h>

#include <stdio.h>

#define JOINTS 3
#define INERTIA_KG_M2 0.4
#define DAMPING_N_M_S_PER_RAD 2.0
#define HOLD_NS 10000000

struct forcebound_device {
  int stopped; /* set by `stop`, on whatever thread */
  int64_t time_ns;
  int64_t commanded_ns;
  double position_rad[JOINTS];
  double speed_rad_per_s[JOINTS];
  double torque_N_m[JOINTS];
};
static struct forcebound_device the_arm;

static int arm_open(const forcebound_setting* settings, size_t count, forcebound_device** arm, char* error,
                    size_t error_bytes) {
  const struct forcebound_device at_rest = {0};
  if (count > 0) {
    snprintf(error, error_bytes, "'%s' is not accepted; this arm has no settings", settings[0].key);
    return FORCEBOUND_FAILED;
  }
  the_arm = at_rest;
  the_arm.position_rad[1] = 0.6;
  the_arm.position_rad[2] = 1.2;
  *arm = &the_arm;
  return FORCEBOUND_OK;
}

/* Turns about z at the base, then about y at the shoulder, 0.3 m up, and at the elbow, 0.35 m above that. */
static int arm_describe(forcebound_device* arm, forcebound_robot* facts) {
  static const double kAxis[JOINTS][3] = {{0, 0, 1}, {0, 1, 0}, {0, 1, 0}};
  static const double kPoint_m[JOINTS][3] = {{0, 0, 0}, {0, 0, 0.3}, {0, 0, 0.65}};
  static const double kCentre_m[JOINTS][3] = {{0, 0, 0.2}, {0, 0, 0.45}, {0, 0, 0.8}};
  static const double kRest_rad[JOINTS] = {0, 0.6, 1.2};
  int i;
  int k;
  (void)arm;
  facts->joints = JOINTS;
  snprintf(facts->name, sizeof facts->name, "invented arm");
  facts->period_s = 1e-3;
  facts->hold_s_max = 1e-9 * HOLD_NS;
  facts->tool_m[2] = 1; /* all joints at zero: straight up */
  facts->tool_speed_m_per_s_max = 1;
  facts->tool_turn_rad_per_s_max = 2;
  for (i = 0; i < JOINTS; ++i) {
    for (k = 0; k < 3; ++k) {
      facts->axis[i][k] = kAxis[i][k];
      facts->point_m[i][k] = kPoint_m[i][k];
      facts->centre_m[i][k] = kCentre_m[i][k];
      facts->inertia_kg_m2[i][k] = 0.005;
    }
    facts->mass_kg[i] = 1;
    facts->rotor_kg_m2[i] = 0.1;
    facts->lowest_rad[i] = -2.8;
    facts->highest_rad[i] = 2.8;
    facts->rest_rad[i] = kRest_rad[i];
    facts->speed_max[i] = 2;
    facts->torque_max[i] = 20;
    facts->torque_rate_max[i] = 2000;
    facts->damping[i] = DAMPING_N_M_S_PER_RAD;
    facts->encoder_step[i] = 1e-5;
  }
  return FORCEBOUND_OK;
}

static int arm_start(forcebound_device* arm) {
  __atomic_store_n(&arm->stopped, 0, __ATOMIC_SEQ_CST);
  return FORCEBOUND_OK;
}

/* The hardware. A torque ends when no new one comes. */
static void pass(forcebound_device* arm, int64_t now_ns) {
  const int64_t step_ns = 50000;
  const double step_s = 1e-9 * (double)step_ns;
  int i;
  if (arm->time_ns == 0) arm->time_ns = now_ns;
  for (; arm->time_ns < now_ns; arm->time_ns += step_ns) {
    const int held = !__atomic_load_n(&arm->stopped, __ATOMIC_SEQ_CST) && arm->time_ns - arm->commanded_ns < HOLD_NS;
    for (i = 0; i < JOINTS; ++i) {
      const double torque_N_m = held ? arm->torque_N_m[i] : 0;
      arm->speed_rad_per_s[i] = (INERTIA_KG_M2 * arm->speed_rad_per_s[i] + step_s * torque_N_m) /
                                (INERTIA_KG_M2 + step_s * DAMPING_N_M_S_PER_RAD);
      arm->position_rad[i] += step_s * arm->speed_rad_per_s[i];
    }
  }
}

static int arm_read(forcebound_device* arm, int64_t now_ns, forcebound_robot_reading* reading) {
  int i;
  pass(arm, now_ns);
  reading->latched_ns = now_ns;
  for (i = 0; i < JOINTS; ++i) reading->position_rad[i] = arm->position_rad[i];
  return FORCEBOUND_OK;
}

static int arm_command(forcebound_device* arm, const forcebound_robot_command* command) {
  int i;
  pass(arm, command->at_ns);
  arm->commanded_ns = command->at_ns;
  for (i = 0; i < JOINTS; ++i) arm->torque_N_m[i] = command->torque_N_m[i];
  return FORCEBOUND_OK;
}

static void arm_stop(forcebound_device* arm) { __atomic_store_n(&arm->stopped, 1, __ATOMIC_SEQ_CST); }

static int arm_resume(forcebound_device* arm) {
  int i;
  for (i = 0; i < JOINTS; ++i) arm->torque_N_m[i] = 0;
  __atomic_store_n(&arm->stopped, 0, __ATOMIC_SEQ_CST);
  return FORCEBOUND_OK;
}

static void arm_close(forcebound_device* arm) { arm_stop(arm); }

static const forcebound_driver the_driver = {
    .size = sizeof the_driver,
    .interface_version = FORCEBOUND_DEVICE_INTERFACE,
    .name = "arm",
    .description = "an invented arm",
    .open = arm_open,
    .start = arm_start,
    .stop = arm_stop,
    .close = arm_close,
    .describe_robot = arm_describe,
    .read_robot = arm_read,
    .command_robot = arm_command,
    .resume = arm_resume,
};

const forcebound_driver* forcebound_driver_entry(uint32_t wanted) {
  (void)wanted;
  return &the_driver;
}
