/* The functions of Force Dimension's libdhd that our driver calls, with a simulated device behind them: a mass on a
 * viscous rail for each axis, which the commanded force moves in real time. What tests do to it, and see of it, are the
 * functions stand_in_*.
 *
 * Like the real one it takes a while for each call, keeps the last force until another comes, fails when the device is
 * unplugged, and gives no force before dhdEnableForce.
 */
#include <pthread.h>
#include <stddef.h>
#include <string.h>
#include <time.h>

#define EXPORT __attribute__((visibility("default")))

static const double kMass_kg = 0.2;
static const double kDamping_N_s_per_m = 4;
static const long kCall_ns = 150000;
static const double kStep_s = 1e-5;

static pthread_mutex_t guard = PTHREAD_MUTEX_INITIALIZER;
static struct {
  int plugged;
  int open;
  int enabled;
  double time_s;
  double position_m[3];
  double speed_m_per_s[3];
  double force_N[3];
  unsigned int buttons;
  double zero_since_s; /* no force since then; below zero: there is one */
  long commands;
} the = {.plugged = 1};

static double now_s(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void pass(void) {
  const double now = now_s();
  double left_s = the.time_s == 0 || now - the.time_s > 1 ? 0 : now - the.time_s;
  the.time_s = now;
  for (; left_s > 0; left_s -= kStep_s) {
    int i;
    for (i = 0; i < 3; ++i) {
      const double force_N = the.plugged && the.enabled ? the.force_N[i] : 0;
      the.speed_m_per_s[i] += kStep_s * (force_N - kDamping_N_s_per_m * the.speed_m_per_s[i]) / kMass_kg;
      the.position_m[i] += kStep_s * the.speed_m_per_s[i];
    }
  }
}

static int call(void) {
  const struct timespec pause = {.tv_sec = 0, .tv_nsec = kCall_ns};
  nanosleep(&pause, NULL);
  return the.plugged && the.open ? 0 : -1;
}

EXPORT int dhdGetDeviceCount(void) { return the.plugged; }

EXPORT int dhdOpenID(char id) {
  int opened = -1;
  pthread_mutex_lock(&guard);
  if (the.plugged && id == 0) {
    the.open = 1;
    the.enabled = 0;
    opened = 0;
  }
  pthread_mutex_unlock(&guard);
  return opened;
}

EXPORT int dhdStop(char id) {
  (void)id;
  pthread_mutex_lock(&guard);
  pass();
  memset(the.force_N, 0, sizeof the.force_N);
  the.enabled = 0;
  pthread_mutex_unlock(&guard);
  return 0;
}

EXPORT int dhdClose(char id) {
  (void)dhdStop(id);
  the.open = 0;
  return 0;
}

EXPORT const char* dhdGetSystemName(char id) {
  (void)id;
  return "omega.3";
}

EXPORT int dhdEnableForce(unsigned char on, char id) {
  (void)id;
  the.enabled = on;
  return the.plugged && the.open ? 0 : -1;
}

EXPORT int dhdGetPosition(double* x, double* y, double* z, char id) {
  int result = call();
  (void)id;
  if (result < 0) return result;
  pthread_mutex_lock(&guard);
  pass();
  *x = the.position_m[0];
  *y = the.position_m[1];
  *z = the.position_m[2];
  pthread_mutex_unlock(&guard);
  return 0;
}

EXPORT int dhdSetForce(double x, double y, double z, char id) {
  int result = call();
  (void)id;
  if (result < 0) return result;
  pthread_mutex_lock(&guard);
  pass();
  the.force_N[0] = x;
  the.force_N[1] = y;
  the.force_N[2] = z;
  ++the.commands;
  if (x != 0 || y != 0 || z != 0) {
    the.zero_since_s = -1;
  } else if (the.zero_since_s < 0) {
    the.zero_since_s = now_s();
  }
  pthread_mutex_unlock(&guard);
  return 0;
}

EXPORT unsigned int dhdGetButtonMask(char id) {
  (void)id;
  return the.buttons;
}

EXPORT const char* dhdErrorGetLastStr(void) { return the.plugged ? "no error" : "no device found"; }

EXPORT void stand_in_plug(int plugged) {
  pthread_mutex_lock(&guard);
  pass();
  the.plugged = plugged;
  if (!plugged) {
    the.open = 0;
    the.enabled = 0;
    memset(the.force_N, 0, sizeof the.force_N);
  }
  pthread_mutex_unlock(&guard);
}

EXPORT void stand_in_press(unsigned int buttons) { the.buttons = buttons; }

/* In libdhd's frame. */
EXPORT void stand_in_force(double* force_N) {
  pthread_mutex_lock(&guard);
  memcpy(force_N, the.force_N, sizeof the.force_N);
  pthread_mutex_unlock(&guard);
}

EXPORT void stand_in_place(double* position_m) {
  pthread_mutex_lock(&guard);
  pass();
  memcpy(position_m, the.position_m, sizeof the.position_m);
  pthread_mutex_unlock(&guard);
}

EXPORT long stand_in_commands(void) { return the.commands; }
