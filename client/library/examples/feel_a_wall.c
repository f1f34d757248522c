/* A client whose device is callbacks: a mass of 0.1 kg that a hand of 2 N pushes to the right, against the scene "wall".
 *
 *     forcebound-server --scene wall &
 *     cc -std=c99 feel_a_wall.c $(pkg-config --cflags --libs forcebound) -o feel_a_wall && ./feel_a_wall 127.0.0.1:47800 */
#include <forcebound.h>

#include <stdio.h>

static const char* kFacts =
    "kind = \"cartesian\"\n"
    "degrees_of_freedom = 1\n"
    "damping_N_s_per_m = 5\n"
    "force_N_max = 20\n"
    "hold_s_max = 0.005\n";

struct mass {
  int64_t now_ns;
  double x_m, v_m_per_s, force_N;
};

/* Where the mass is by now, by small steps since it was last read. */
static fb_status read_mass(void* user, fb_reading* reading) {
  struct mass* mass = user;
  if (mass->now_ns == 0) mass->now_ns = reading->latched_ns;
  for (; mass->now_ns + 10000 <= reading->latched_ns; mass->now_ns += 10000) {
    mass->v_m_per_s += 1e-5 * (2 + mass->force_N - 5 * mass->v_m_per_s) / 0.1;
    mass->x_m += 1e-5 * mass->v_m_per_s;
  }
  reading->position_m[0] = mass->x_m;
  return FB_OK;
}

static fb_status command_mass(void* user, const double* force_N, size_t axes) {
  ((struct mass*)user)->force_N = axes == 1 ? force_N[0] : 0;
  return FB_OK;
}

int main(int count, char** arguments) {
  struct mass mass = {0, -0.01, 0, 0};
  fb_facts* facts = NULL;
  fb_device* device = NULL;
  fb_client* client = NULL;
  fb_device_callbacks callbacks = FB_INIT(fb_device_callbacks);
  callbacks.user = &mass;
  callbacks.read = read_mass;
  callbacks.command = command_mass;
  fb_client_settings settings = FB_INIT(fb_client_settings);
  settings.server = count > 1 ? arguments[1] : "127.0.0.1:47800";
  settings.duration_s = 2;
  settings.once = 1;
  fb_client_state state = FB_INIT(fb_client_state);
  if (fb_facts_parse(kFacts, "mass", &facts) || fb_device_of_callbacks(facts, &callbacks, &device) ||
      fb_client_create(&settings, device, &client) || fb_client_start(client) || fb_client_wait(client, -1) ||
      fb_client_look(client, &state))
    return fprintf(stderr, "%s\n", fb_last_error()), 1;
  printf("%s: after %.1f s the wall pushes with %.2f N, %.2f mm deep\n", state.simulated, 1e-3 * (double)state.ticks,
         state.force_N[0], 1e3 * state.position_m[0]);
  fb_client_destroy(client); /* before `mass` ends */
  return 0;
}
