/* Laws with one thing wrong each, as the definitions say: the others pass the request on. */
#define _POSIX_C_SOURCE 200809L
#include <forcebound/law_plugin/forcebound_law.h>

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#ifndef INTERFACE
#define INTERFACE FORCEBOUND_LAW_INTERFACE
#endif
#ifndef NAME
#define NAME "wrong"
#endif
#ifndef STANDARD
#define STANDARD 1
#endif
#ifndef SIZE
#define SIZE sizeof(forcebound_law_functions)
#endif

#ifndef WITHOUT_ENTRY
struct forcebound_law {
  int axes;
  int ticks;
};

static int wrong_create(const forcebound_law_facts* facts, const double* parameters, forcebound_law** law, char* error,
                        size_t error_bytes) {
  (void)parameters;
#ifdef REFUSES
  strncpy(error, REFUSES, error_bytes - 1);
  return FORCEBOUND_LAW_FAILED;
#endif
  (void)error, (void)error_bytes;
  *law = calloc(1, sizeof **law);
  (*law)->axes = facts->degrees_of_freedom;
  return FORCEBOUND_LAW_OK;
}

#ifndef WITHOUT_TICK
static int wrong_tick(forcebound_law* law, const forcebound_law_reading* reading, const forcebound_law_request* request,
                      forcebound_law_force* force) {
  (void)reading;
  memcpy(force->force_N, request->force_N, sizeof force->force_N);
  ++law->ticks;
#ifdef NOT_FINITE
  if (law->ticks % 2 == 0) force->force_N[0] = NAN;
#endif
#ifdef FAILS
  return FORCEBOUND_LAW_FAILED;
#endif
#ifdef CRASHES
  if (law->ticks > 100) abort();
#endif
#ifdef SLEEPS_NS
  const struct timespec pause = {.tv_sec = 0, .tv_nsec = SLEEPS_NS};
  nanosleep(&pause, NULL);
#endif
  return FORCEBOUND_LAW_OK;
}
#else
#define wrong_tick NULL
#endif

static void wrong_destroy(forcebound_law* law) { free(law); }

static const forcebound_law_parameter kParameter = {"gain", "of nothing", 0, 2, STANDARD};
static const forcebound_law_functions kWrong = {
    .size = SIZE,
    .interface_version = INTERFACE,
    .name = NAME,
    .parameters = &kParameter,
    .parameter_count = 1,
    .create = wrong_create,
    .tick = wrong_tick,
    .destroy = wrong_destroy,
};

const forcebound_law_functions* forcebound_law_entry(uint32_t wanted) {
  (void)wanted;
  return &kWrong;
}
#else
int nothing_of_a_law(void);
int nothing_of_a_law(void) { return 0; }
#endif
