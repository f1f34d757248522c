/* A server whose environment is callbacks: for each client a spring of 200 N/m to where its device was first.
 *
 *     cc -std=c99 serve_a_spring.c $(pkg-config --cflags --libs forcebound) -o serve_a_spring && ./serve_a_spring
 *     forcebound-client --server 127.0.0.1:47800 --device wall-1dof --operator press */
#include <forcebound.h>

#include <stdio.h>
#include <stdlib.h>

struct spring {
  int held;
  double end_m[3];
};

static fb_status create_spring(void* user, const fb_client_facts* client, void** own) {
  (void)user;
  printf("device '%s' comes\n", client->device);
  *own = calloc(1, sizeof(struct spring));
  return *own ? FB_OK : FB_NO_MEMORY;
}

static fb_status update_spring(void* own, const fb_client_motion* motion, fb_answer* answer) {
  struct spring* spring = own;
  for (int k = 0; k < 3; ++k) {
    if (!spring->held) spring->end_m[k] = motion->position_m[k];
    answer->force_N[k] = 200 * (spring->end_m[k] - motion->position_m[k]);
    answer->stiffness_N_per_m[4 * k] = 200; /* so that the client goes on by itself between answers */
  }
  spring->held = 1;
  answer->radius_m = 0.1;
  answer->has = FB_HAS_STIFFNESS;
  return FB_OK;
}

static void destroy_spring(void* own) {
  puts("a device left");
  free(own);
}

int main(int count, char** arguments) {
  fb_server* server = NULL;
  fb_server_state state = FB_INIT(fb_server_state);
  fb_server_settings settings = FB_INIT(fb_server_settings);
  fb_environment environment = FB_INIT(fb_environment);
  settings.listen = count > 1 ? arguments[1] : NULL; /* "127.0.0.1:0": any free port */
  environment.name = "spring";
  environment.create = create_spring;
  environment.update = update_spring;
  environment.destroy = destroy_spring;
  if (fb_server_create(&settings, &environment, &server) || fb_server_start(server) || fb_server_look(server, &state))
    return fprintf(stderr, "%s\n", fb_last_error()), 1;
  printf("serving at %s until the end of the input\n", state.address);
  fflush(stdout);
  while (getchar() != EOF) continue;
  fb_server_look(server, &state);
  printf("%llu forces sent\n", (unsigned long long)state.forces);
  fb_server_destroy(server);
  return 0;
}
