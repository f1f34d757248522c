/* A MuJoCo model of yours, stepped in real time and felt: forces come from its contacts 60 times a second, and go on in
 * between.
 *
 *     cc -std=c99 step_mujoco.c $(pkg-config --cflags --libs forcebound) -lmujoco -lm -o step_mujoco
 *     ./step_mujoco model.xml 60
 *     forcebound-client --server 127.0.0.1:47800 --device firm-3dof */
#define _POSIX_C_SOURCE 200809L
#include <forcebound.h>
#include <mujoco/mujoco.h>

#include <libgen.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define PROBES 4
#define RADIUS_M 0.005
#define NEAR_M 0.02

/* The model with a ball for each probe, which is seen by its contacts and pushes nothing: they all lie in the gap. */
static mjModel* load(char* path, char* error, int bytes) {
  static mjVFS files;
  char text[4096], folder[2048];
  int length = snprintf(folder, sizeof folder, "%s", path);
  if (length >= (int)sizeof folder || chdir(dirname(folder))) return snprintf(error, bytes, "no such folder"), NULL;
  length = snprintf(text, sizeof text, "<mujoco><include file=\"%s\"/><worldbody>", basename(path));
  for (int k = 0; k < PROBES; ++k)
    length +=
        snprintf(text + length, sizeof text - length,
                 "<body name=\"forcebound_probe_%d\" mocap=\"true\" pos=\"0 0 %d\"><geom type=\"sphere\" size=\"%g\" "
                 "contype=\"2147483647\" conaffinity=\"2147483647\" margin=\"%g\" gap=\"1\"/></body>",
                 k, 100 + k, RADIUS_M, NEAR_M);
  length += snprintf(text + length, sizeof text - length, "</worldbody></mujoco>");
  mj_defaultVFS(&files);
  mj_makeEmptyFileVFS(&files, "forcebound.xml", length);
  memcpy(files.filedata[0], text, length);
  return mj_loadXML("forcebound.xml", &files, error, bytes);
}

static int body_of_probe(const mjModel* model, int k) {
  char name[32];
  snprintf(name, sizeof name, "forcebound_probe_%d", k);
  return mj_name2id(model, mjOBJ_BODY, name);
}

/* What a body slides on holds it by so much across a normal. */
static double held_N(const mjModel* model, const mjData* data, int body, const double normal[3]) {
  double sum_N = 0;
  mjtNum force[6];
  for (int c = 0; c < data->ncon; ++c) {
    const mjContact* contact = &data->contact[c];
    if (model->geom_bodyid[contact->geom1] != body && model->geom_bodyid[contact->geom2] != body) continue;
    if (contact->efc_address < 0 || fabs(mju_dot3(contact->frame, normal)) > 0.5) continue;
    mj_contactForce(model, data, c, force);
    sum_N += contact->friction[0] * force[0];
  }
  return sum_N;
}

/* What a contact says of the geometry that is not the probe's. */
static fb_touch touch_of(const mjModel* model, mjData* data, const mjContact* contact, int other, double sign) {
  fb_touch touch = FB_INIT(fb_touch);
  const int body = model->geom_bodyid[other];
  mjtNum* jacobian = malloc(sizeof(mjtNum) * 6 * (model->nv + 1));
  mjtNum* solved = jacobian + 3 * model->nv;
  double along_m_per_s2 = 0, along_per_kg = 0;
  touch.body = body;
  touch.friction = contact->friction[0];
  touch.radius_m = model->geom_type[other] == mjGEOM_PLANE ? 0 : 0.01;
  for (int i = 0; i < 3; ++i) {
    touch.normal[i] = sign * contact->frame[i];
    touch.place_m[i] = contact->pos[i] - contact->dist / 2 * touch.normal[i];
  }
  if (model->nv > 0) {
    mj_jac(model, data, jacobian, NULL, touch.place_m, body);
    mj_solveM(model, data, solved, jacobian, 3);
  }
  for (int i = 0; i < 3; ++i) {
    touch.velocity_m_per_s[i] = mju_dot(jacobian + i * model->nv, data->qvel, model->nv);
    along_m_per_s2 += touch.normal[i] * mju_dot(jacobian + i * model->nv, data->qacc, model->nv);
    for (int j = 0; j < 3; ++j)
      touch.mobility_per_kg[3 * i + j] = mju_dot(jacobian + i * model->nv, solved + j * model->nv, model->nv);
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < i; ++j)
      touch.mobility_per_kg[3 * i + j] = touch.mobility_per_kg[3 * j + i] =
          (touch.mobility_per_kg[3 * i + j] + touch.mobility_per_kg[3 * j + i]) / 2;
  for (int i = 0; i < 9; ++i) along_per_kg += touch.normal[i / 3] * touch.mobility_per_kg[i] * touch.normal[i % 3];
  for (int i = 0; i < 3 && along_per_kg > 0; ++i) touch.others_N[i] = touch.normal[i] * along_m_per_s2 / along_per_kg;
  touch.dry_friction_N = held_N(model, data, body, touch.normal);
  free(jacobian);
  return touch;
}

/* The nearest contacts of a probe's ball. */
static size_t touches_of(const mjModel* model, mjData* data, int ball, fb_touch touches[FB_TOUCHES_MAX]) {
  double distances_m[FB_TOUCHES_MAX];
  size_t count = 0;
  for (int c = 0; c < data->ncon; ++c) {
    const mjContact* contact = &data->contact[c];
    const int first = model->geom_bodyid[contact->geom1] == ball;
    size_t k = count < FB_TOUCHES_MAX ? count : 0;
    if (!first && model->geom_bodyid[contact->geom2] != ball) continue;
    if (count == FB_TOUCHES_MAX) {
      for (size_t i = 1; i < count; ++i) k = distances_m[i] > distances_m[k] ? i : k;
      if (contact->dist >= distances_m[k]) continue;
    } else {
      ++count;
    }
    distances_m[k] = contact->dist;
    touches[k] = touch_of(model, data, contact, first ? contact->geom2 : contact->geom1, first ? -1 : 1);
  }
  return count;
}

static void push(const mjModel* model, mjData* data, fb_server* server, size_t probes, double step_s) {
  const mjtNum no_torque[3] = {0, 0, 0};
  mjtNum force_N[3];
  mju_zero(data->qfrc_applied, model->nv);
  for (size_t k = 0; k < probes; ++k) {
    fb_push push = FB_INIT(fb_push);
    for (size_t i = 0; fb_server_push(server, k, i, &push) == FB_OK; ++i) {
      mju_scl3(force_N, push.impulse_Ns, 1 / step_s);
      mj_applyFT(model, data, force_N, no_torque, push.place_m, (int)push.body, data->qfrc_applied);
    }
  }
}

/* Steps it until `time_s`, and reports what each probe meets then. */
static void step(const mjModel* model, mjData* data, fb_server* server, double time_s) {
  size_t probes = 0;
  fb_server_ask(server, &probes);
  if (probes > PROBES) probes = PROBES;
  for (size_t k = 0; k < probes; ++k) {
    fb_probe probe = FB_INIT(fb_probe);
    fb_server_probe(server, k, &probe);
    mju_copy3(data->mocap_pos + 3 * model->body_mocapid[body_of_probe(model, (int)k)], probe.place_m);
  }
  const double step_s = time_s - data->time;
  while (data->time < time_s) {
    push(model, data, server, probes, step_s);
    mj_step(model, data);
  }
  mju_zero(data->qfrc_applied, model->nv);
  mj_forward(model, data);
  for (size_t k = 0; k < probes; ++k) {
    fb_touch touches[FB_TOUCHES_MAX];
    fb_probe probe = FB_INIT(fb_probe);
    const size_t count = touches_of(model, data, body_of_probe(model, (int)k), touches);
    fb_server_probe(server, k, &probe);
    if (fb_server_report(server, probe.client, touches, count) == FB_INVALID) fprintf(stderr, "%s\n", fb_last_error());
  }
}

int main(int count, char** arguments) {
  char error[1000] = "usage: step_mujoco MODEL.xml [HZ] [HOST:PORT] [SECONDS]";
  const double rate_Hz = count > 2 ? atof(arguments[2]) : 60, duration_s = count > 4 ? atof(arguments[4]) : 600;
  fb_server* server = NULL;
  fb_server_state state = FB_INIT(fb_server_state);
  fb_server_settings settings = FB_INIT(fb_server_settings);
  fb_simulator simulator = FB_INIT(fb_simulator);
  mjModel* model = count > 1 && rate_Hz >= 1 ? load(arguments[1], error, sizeof error) : NULL;
  mjData* data = model ? mj_makeData(model) : NULL;
  struct timespec next;
  if (!data) return fprintf(stderr, "%s\n", error), 1;
  settings.listen = count > 3 ? arguments[3] : NULL;
  settings.clients_max = PROBES;
  simulator.name = "mujoco";
  simulator.probe_radius_m = RADIUS_M;
  if (fb_server_of_simulator(&settings, &simulator, &server) || fb_server_start(server) ||
      fb_server_look(server, &state))
    return fprintf(stderr, "%s\n", fb_last_error()), 1;
  printf("stepping at %s, %g times a second\n", state.address, rate_Hz);
  fflush(stdout);
  clock_gettime(CLOCK_MONOTONIC, &next);
  for (long steps = 1; steps < duration_s * rate_Hz; ++steps) {
    step(model, data, server, steps / rate_Hz);
    next.tv_nsec += (long)(1e9 / rate_Hz);
    next.tv_sec += next.tv_nsec / 1000000000;
    next.tv_nsec %= 1000000000;
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, NULL);
  }
  fb_server_look(server, &state);
  printf("%llu reports, %llu refused\n", (unsigned long long)state.reports, (unsigned long long)state.reports_refused);
  fb_server_destroy(server);
  mj_deleteData(data);
  mj_deleteModel(model);
  return 0;
}
