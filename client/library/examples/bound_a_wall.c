/* A law's loop: a mass of 50 g pressed into a wall that is far too stiff for it, ticked at 1 kHz. With "none" for a law
 * the wall throws it back faster than it came; with "fba-exact" it returns no more energy than damping took.
 *
 *     cc -std=c99 bound_a_wall.c $(pkg-config --cflags --libs forcebound) -o bound_a_wall && ./bound_a_wall fba-exact */
#include <forcebound.h>

#include <stdio.h>

static const char* kFacts =
    "kind = \"cartesian\"\n"
    "degrees_of_freedom = 1\n"
    "damping_N_s_per_m = 2\n"
    "force_N_max = 20\n"
    "hold_s_max = 0.0011\n";

/* Until the next tick, in small steps: mass, damping and the force that the device holds. */
static void move(double* x_m, double* v_m_per_s, double force_N) {
  for (int step = 0; step < 100; ++step) {
    *v_m_per_s += 1e-5 * (force_N - 2 * *v_m_per_s) / 0.05;
    *x_m += 1e-5 * *v_m_per_s;
  }
}

static int failed(void) {
  fprintf(stderr, "%s\n", fb_last_error());
  return 1;
}

int main(int count, char** arguments) {
  const char* name = count > 1 ? arguments[1] : "fba-exact";
  fb_facts* facts;
  fb_law* law;
  if (fb_facts_parse(kFacts, "mass", &facts) != FB_OK) return failed();
  if (fb_law_create(name, facts, NULL, &law) != FB_OK) return failed();

  double x_m = -0.001, v_m_per_s = 0.2, fastest_m_per_s = 0;
  for (int n = 0; n < 1000; ++n) {
    fb_motion motion = FB_INIT(fb_motion);
    motion.interval_s = n == 0 ? 0 : 0.001;
    motion.position[0] = x_m;
    const double request_N = x_m > 0 ? -20000 * x_m : 0;
    double force_N;
    if (fb_law_tick(law, &motion, &request_N, &force_N, 1) != FB_OK) return failed();
    move(&x_m, &v_m_per_s, force_N); /* here a program commands its device */
    if (-v_m_per_s > fastest_m_per_s) fastest_m_per_s = -v_m_per_s;
  }
  fb_ledger ledger = FB_INIT(fb_ledger);
  if (fb_law_ledger(law, &ledger) != FB_OK) return failed();
  printf("%s: came with 0.200 m/s, thrown back with %.3f m/s; %.3f mJ may be spent, %llu requests were too large\n", name,
         fastest_m_per_s, 1e3 * ledger.energy_J, (unsigned long long)ledger.saturated);
  fb_law_destroy(law);
  fb_facts_destroy(facts);
  return 0;
}
