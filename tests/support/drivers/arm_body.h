/* The hardware of arm.c: seven joints, each a flywheel with damping, and a floor under the tool. */
#ifndef FORCEBOUND_TESTS_ARM_BODY_H
#define FORCEBOUND_TESTS_ARM_BODY_H

#include <stdint.h>

#define ARM_JOINTS 7
#define ARM_HOLD_NS 10000000
#define ARM_OPENS_NS 50000000 /* its brakes */

/* All joints at zero: straight up. */
extern const double kArmAxis[ARM_JOINTS][3];
extern const double kArmPoint_m[ARM_JOINTS][3];
extern const double kArmTool_m[3];
extern const double kArmRest_rad[ARM_JOINTS]; /* the tool points down, 40 mm above the floor */
extern const double kArmMass_kg;              /* of each link, in the middle between its joint and the next one */
extern const double kArmInertia_kg_m2[ARM_JOINTS];
extern const double kArmDamping[ARM_JOINTS]; /* [N m s/rad] */

/* Of its brakes. They are said to hold until they are open, and let go halfway. */
enum { ARM_IS_OPEN, ARM_IS_STOPPED, ARM_IS_OPENING };

typedef struct arm_body {
  int brakes;   /* closed by `stop`, on whatever thread */
  int has_mass; /* and weighs something: the motors are to hold it */
  int64_t hold_ns; /* ARM_HOLD_NS after a reset */
  int64_t time_ns;
  int64_t commanded_ns;
  int64_t released_ns; /* 0: the torque is held */
  int64_t opens_ns;    /* when the brakes are open, while they are opening */
  double position_rad[ARM_JOINTS];
  double speed_rad_per_s[ARM_JOINTS];
  double torque_N_m[ARM_JOINTS];
  double floor_N;  /* that the floor exerts on the tool, upwards */
  double energy_J; /* what the joints dissipated, without the brakes, less what the motors gave beyond the weight */
  double energy_J_least;
} arm_body;

void arm_body_reset(arm_body* arm);

/* Until then, exactly: a step ends there, and where a torque is released. */
void arm_body_pass(arm_body* arm, int64_t now_ns);

/* Any thread. The brakes close when the next time passes. */
void arm_body_stop(arm_body* arm);
int arm_body_is_stopped(const arm_body* arm);

/* They are open after so long, unless they are closed meanwhile. */
void arm_body_open(arm_body* arm, int64_t after_ns);

void arm_body_command(arm_body* arm, int64_t at_ns, const double* torque_N_m);

#endif
