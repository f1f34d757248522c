#include "arm_body.h"

#include <math.h>
#include <string.h>

#define STEP_NS 100000
#define GAP_NS 1000000000 /* more is not simulated */
#define FLOOR_N_PER_M 3000.0
#define CLEARANCE_M 0.04
#define BRAKES 50.0 /* [N m s/rad] */
#define GRAVITY_M_PER_S2 9.81

const double kArmAxis[ARM_JOINTS][3] = {{0, 0, 1}, {0, 1, 0}, {0, 0, 1}, {0, 1, 0}, {0, 0, 1}, {0, 1, 0}, {0, 0, 1}};
const double kArmPoint_m[ARM_JOINTS][3] = {{0, 0, 0},   {0, 0, 0.3}, {0, 0, 0.5}, {0, 0, 0.65},
                                           {0, 0, 0.8}, {0, 0, 1},   {0, 0, 1.1}};
const double kArmTool_m[3] = {0, 0, 1.2};
const double kArmRest_rad[ARM_JOINTS] = {0, 0.5, 0, 1.6, 0, 1.0415926535897931, 0};
const double kArmMass_kg = 0.2;
const double kArmInertia_kg_m2[ARM_JOINTS] = {0.4, 0.4, 0.4, 0.4, 0.1, 0.1, 0.1};
const double kArmDamping[ARM_JOINTS] = {5, 5, 5, 5, 1, 1, 1};

typedef struct arm_pose {
  double axis[ARM_JOINTS][3];
  double point_m[ARM_JOINTS][3];
  double centre_m[ARM_JOINTS][3];
  double tool_m[3];
} arm_pose;

static void cross(const double* a, const double* b, double* product) {
  product[0] = a[1] * b[2] - a[2] * b[1];
  product[1] = a[2] * b[0] - a[0] * b[2];
  product[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Turns the columns of `frame` about a unit axis, by Rodrigues' formula. */
static void turn(double frame[3][3], const double* axis, double angle_rad) {
  int k;
  for (k = 0; k < 3; ++k) {
    double* const column = frame[k];
    const double along = (1 - cos(angle_rad)) * dot(axis, column);
    double across[3];
    int i;
    cross(axis, column, across);
    for (i = 0; i < 3; ++i) {
      column[i] = cos(angle_rad) * column[i] + sin(angle_rad) * across[i] + along * axis[i];
    }
  }
}

/* frame * (to - from), from `origin`. */
static void place(double frame[3][3], const double* origin, const double* from, const double* to, double* found) {
  int i;
  for (i = 0; i < 3; ++i) {
    found[i] = origin[i] + frame[0][i] * (to[0] - from[0]) + frame[1][i] * (to[1] - from[1]) +
               frame[2][i] * (to[2] - from[2]);
  }
}

static void find_pose(const double* position_rad, arm_pose* pose) {
  static const double kOrigin[3] = {0, 0, 0};
  double frame[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  int i;
  int k;
  for (i = 0; i < ARM_JOINTS; ++i) {
    const double* const next_m = i + 1 < ARM_JOINTS ? kArmPoint_m[i + 1] : kArmTool_m;
    double centre_m[3];
    const double* const before_m = i > 0 ? kArmPoint_m[i - 1] : kOrigin;
    place(frame, i > 0 ? pose->point_m[i - 1] : kOrigin, before_m, kArmPoint_m[i], pose->point_m[i]);
    place(frame, kOrigin, kOrigin, kArmAxis[i], pose->axis[i]);
    turn(frame, pose->axis[i], position_rad[i]);
    for (k = 0; k < 3; ++k) centre_m[k] = (kArmPoint_m[i][k] + next_m[k]) / 2;
    place(frame, pose->point_m[i], kArmPoint_m[i], centre_m, pose->centre_m[i]);
  }
  place(frame, pose->point_m[ARM_JOINTS - 1], kArmPoint_m[ARM_JOINTS - 1], kArmTool_m, pose->tool_m);
}

/* Torque about a joint of a force along z at a point. */
static double torque_of(const arm_pose* pose, int joint, const double* point_m, double force_N) {
  double arm_m[3];
  double lever[3];
  int k;
  for (k = 0; k < 3; ++k) arm_m[k] = point_m[k] - pose->point_m[joint][k];
  cross(pose->axis[joint], arm_m, lever);
  return lever[2] * force_N;
}

static double weight_N_m(const arm_body* arm, const arm_pose* pose, int joint) {
  double torque_N_m = 0;
  int link;
  if (!arm->has_mass) return 0;
  for (link = joint; link < ARM_JOINTS; ++link) {
    torque_N_m += torque_of(pose, joint, pose->centre_m[link], -kArmMass_kg * GRAVITY_M_PER_S2);
  }
  return torque_N_m;
}

static double floor_m(void) {
  arm_pose rest;
  find_pose(kArmRest_rad, &rest);
  return rest.tool_m[2] - CLEARANCE_M;
}

/* Damping at the step's end: it takes b v^2 of the very v of the step. */
static void step(arm_body* arm, int64_t length_ns, int braked) {
  const double step_s = 1e-9 * (double)length_ns;
  arm_pose pose;
  int i;
  find_pose(arm->position_rad, &pose);
  arm->floor_N = FLOOR_N_PER_M * fmax(0, floor_m() - pose.tool_m[2]);
  for (i = 0; i < ARM_JOINTS; ++i) {
    const double motor_N_m = arm->released_ns == 0 ? arm->torque_N_m[i] : 0;
    const double weight = weight_N_m(arm, &pose, i);
    const double torque_N_m =
        motor_N_m + torque_of(&pose, i, pose.tool_m, arm->floor_N) + (braked ? 0 : weight);
    const double damping = kArmDamping[i] + (braked ? BRAKES : 0);
    const double speed = (kArmInertia_kg_m2[i] * arm->speed_rad_per_s[i] + step_s * torque_N_m) /
                         (kArmInertia_kg_m2[i] + step_s * damping);
    arm->speed_rad_per_s[i] = speed;
    arm->position_rad[i] += step_s * speed;
    arm->energy_J += step_s * speed * (kArmDamping[i] * speed - motor_N_m);
  }
  arm->energy_J_least = fmin(arm->energy_J_least, arm->energy_J);
}

void arm_body_reset(arm_body* arm) {
  const int has_mass = arm->has_mass;
  memset(arm, 0, sizeof *arm);
  arm->has_mass = has_mass;
  arm->hold_ns = ARM_HOLD_NS;
  memcpy(arm->position_rad, kArmRest_rad, sizeof arm->position_rad);
}

static int brakes_of(const arm_body* arm) { return __atomic_load_n(&arm->brakes, __ATOMIC_SEQ_CST); }

static int is_braked(const arm_body* arm) {
  const int brakes = brakes_of(arm);
  return brakes == ARM_IS_STOPPED || (brakes == ARM_IS_OPENING && arm->time_ns < arm->opens_ns - ARM_OPENS_NS / 2);
}

void arm_body_pass(arm_body* arm, int64_t now_ns) {
  if (arm->time_ns == 0 || now_ns - arm->time_ns > GAP_NS) arm->time_ns = now_ns;
  while (arm->time_ns < now_ns) {
    const int64_t release_ns = arm->commanded_ns + arm->hold_ns;
    const int braked = is_braked(arm);
    int64_t length_ns = now_ns - arm->time_ns;
    if (arm->released_ns == 0 && (braked || arm->time_ns >= release_ns)) arm->released_ns = arm->time_ns;
    if (length_ns > STEP_NS) length_ns = STEP_NS;
    if (arm->released_ns == 0 && length_ns > release_ns - arm->time_ns) length_ns = release_ns - arm->time_ns;
    step(arm, length_ns, braked);
    arm->time_ns += length_ns;
  }
  if (now_ns >= arm->opens_ns) {
    int opening = ARM_IS_OPENING;
    __atomic_compare_exchange_n(&arm->brakes, &opening, ARM_IS_OPEN, 0, __ATOMIC_SEQ_CST, __ATOMIC_SEQ_CST);
  }
}

void arm_body_stop(arm_body* arm) { __atomic_store_n(&arm->brakes, ARM_IS_STOPPED, __ATOMIC_SEQ_CST); }

int arm_body_is_stopped(const arm_body* arm) { return brakes_of(arm) != ARM_IS_OPEN; }

void arm_body_open(arm_body* arm, int64_t after_ns) {
  arm->opens_ns = arm->time_ns + after_ns;
  __atomic_store_n(&arm->brakes, ARM_IS_OPENING, __ATOMIC_SEQ_CST);
}

void arm_body_command(arm_body* arm, int64_t at_ns, const double* torque_N_m) {
  arm_body_pass(arm, at_ns);
  arm->commanded_ns = at_ns;
  arm->released_ns = 0;
  memcpy(arm->torque_N_m, torque_N_m, sizeof arm->torque_N_m);
}
