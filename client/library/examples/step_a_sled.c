/* A simulator that steps 60 times a second: a box of 0.6 kg on a table, which is pushed along -z by its face.
 *
 *     cc -std=c99 step_a_sled.c $(pkg-config --cflags --libs forcebound) -lm -o step_a_sled && ./step_a_sled
 *     forcebound-client --server 127.0.0.1:47800 --device firm-3dof \
 *         --operator press:axis=2,from_m=0.01,to_m=-0.02 */
#define _POSIX_C_SOURCE 200112L
#include <forcebound.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define STEP_S (1.0 / 60)
static const double mass_kg = 0.6, dry_N = 1.8; /* 0.3 of its weight */

struct sled {
  double face_m;
  double speed_m_per_s;
};

static void step(struct sled* sled, double pushed_N) {
  const double free = sled->speed_m_per_s + STEP_S * pushed_N / mass_kg;
  const double rubbed = fmin(fabs(free), STEP_S * dry_N / mass_kg);
  sled->speed_m_per_s = free - copysign(rubbed, free);
  sled->face_m += STEP_S * sled->speed_m_per_s;
}

/* What a probe there meets: the face, and what it takes to push it. */
static fb_touch touch_of(const struct sled* sled, const fb_probe* probe) {
  fb_touch touch = FB_INIT(fb_touch);
  touch.place_m[0] = probe->place_m[0];
  touch.place_m[1] = probe->place_m[1];
  touch.place_m[2] = sled->face_m;
  touch.normal[2] = 1;
  touch.velocity_m_per_s[2] = sled->speed_m_per_s;
  touch.mobility_per_kg[8] = 1 / mass_kg;
  touch.dry_friction_N = dry_N;
  touch.friction = 0.4;
  return touch;
}

int main(int count, char** arguments) {
  fb_server* server = NULL;
  fb_server_state state = FB_INIT(fb_server_state);
  fb_server_settings settings = FB_INIT(fb_server_settings);
  fb_simulator simulator = FB_INIT(fb_simulator);
  const struct timespec pause = {0, (long)(1e9 * STEP_S)}; /* that a step here takes no time is of no account */
  const double duration_s = count > 2 ? atof(arguments[2]) : 600;
  struct sled sled = {0, 0};
  settings.listen = count > 1 ? arguments[1] : NULL; /* "127.0.0.1:0": any free port */
  simulator.name = "sled";
  if (fb_server_of_simulator(&settings, &simulator, &server) || fb_server_start(server) ||
      fb_server_look(server, &state))
    return fprintf(stderr, "%s\n", fb_last_error()), 1;
  printf("stepping at %s for %g s\n", state.address, duration_s);
  fflush(stdout);
  for (long steps = 0; steps * STEP_S < duration_s; ++steps) {
    size_t probes = 0;
    double pushed_Ns = 0;
    fb_probe probe = FB_INIT(fb_probe);
    fb_push push = FB_INIT(fb_push);
    fb_server_ask(server, &probes);
    for (size_t k = 0; k < probes; ++k)
      for (size_t i = 0; fb_server_push(server, k, i, &push) == FB_OK; ++i) pushed_Ns += push.impulse_Ns[2];
    step(&sled, pushed_Ns / STEP_S);
    for (size_t k = 0; fb_server_probe(server, k, &probe) == FB_OK; ++k) {
      const fb_touch touch = touch_of(&sled, &probe);
      if (fb_server_report(server, probe.client, &touch, 1) == FB_INVALID) fprintf(stderr, "%s\n", fb_last_error());
    }
    nanosleep(&pause, NULL);
  }
  fb_server_look(server, &state);
  printf("%llu reports, the sled went %.1f mm\n", (unsigned long long)state.reports, -1000 * sled.face_m);
  fb_server_destroy(server);
  return 0;
}
