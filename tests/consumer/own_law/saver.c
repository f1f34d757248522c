/* A law for Cartesian devices, complete: it spends a share of what the damping has dissipated and no force has returned.
 * With share = 1 it is `fba-less` [Kim 2015, eqs. 17 and 21] on a device whose axes do not damp each other. */
#include <forcebound/law_plugin/forcebound_law.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

struct forcebound_law {
  int axes;
  double share, period_s, damping[FORCEBOUND_LAW_AXES_MAX], position[FORCEBOUND_LAW_AXES_MAX], energy_J;
};

static int create(const forcebound_law_facts* facts, const double* parameters, forcebound_law** law, char* error,
                  size_t error_bytes) {
  if (!facts->cartesian) {
    snprintf(error, error_bytes, "'%s' is not Cartesian", facts->name);
    return FORCEBOUND_LAW_FAILED;
  }
  *law = calloc(1, sizeof **law);
  (*law)->axes = facts->degrees_of_freedom;
  (*law)->share = parameters[0];
  (*law)->period_s = facts->period_s;
  for (int i = 0; i < facts->joints; ++i) (*law)->damping[i] = facts->damping[i * facts->joints + i];
  return FORCEBOUND_LAW_OK;
}

static int tick(forcebound_law* law, const forcebound_law_reading* reading, const forcebound_law_request* request,
                forcebound_law_force* force) {
  double cost_J = 0; /* the most that the requested force can return in a period, beyond what the damping takes */
  for (int i = 0; i < law->axes; ++i) {
    if (!(reading->has & FORCEBOUND_LAW_LOST)) {
      const double moved_m = reading->interval_s > 0 ? reading->position[i] - law->position[i] : 0;
      law->energy_J += (law->damping[i] / law->period_s * moved_m - reading->held_N[i]) * moved_m;
      law->position[i] = reading->position[i];
    }
    cost_J += request->force_N[i] * request->force_N[i] * law->period_s / (4 * law->damping[i]);
  }
  const double spent_J = law->share * fmax(law->energy_J, 0);
  const double scale = cost_J > spent_J ? sqrt(spent_J / cost_J) : 1;
  for (int i = 0; i < law->axes; ++i) force->force_N[i] = scale * request->force_N[i];
  force->energy_J = law->energy_J;
  return FORCEBOUND_LAW_OK;
}

static void destroy(forcebound_law* law) { free(law); }

static const forcebound_law_parameter share = {"share", "of the energy saved that a tick may spend", 0.01, 1, 1};
static const forcebound_law_functions saver = {
    .size = sizeof saver,
    .interface_version = FORCEBOUND_LAW_INTERFACE,
    .name = "saver",
    .summary = "spends a share of the energy saved",
    .promise = FORCEBOUND_LAW_PASSIVE_IF_IDEAL,
    .shortens = 1,
    .parameters = &share,
    .parameter_count = 1,
    .create = create,
    .tick = tick,
    .destroy = destroy,
};

const forcebound_law_functions* forcebound_law_entry(uint32_t wanted) {
  (void)wanted;
  return &saver;
}
