/* What the C library computes without a network, to the last digit: the same lines are to come from it on every system.
 * Then what it refuses. */
#include <forcebound.h>

#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

static uint64_t hash = 0;

static void add(double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  hash = (hash ^ bits) * UINT64_C(0x9e3779b97f4a7c15);
  hash ^= hash >> 29;
}

/* In six small steps a tick, against a wall of 5000 N/m at x = 0 that is felt 20 ticks late. */
static int feel(const char* name, const fb_facts* facts, const fb_facts_info* info) {
  enum { kTicks = 4000, kLate = 20 };
  const size_t axes = (size_t)info->axes;
  double late_N[kLate] = {0}, x_m = -0.01, v_m_per_s = 0.15, force_N[FB_AXES_MAX] = {0};
  fb_law* law = NULL;
  fb_ledger ledger = FB_INIT(fb_ledger);
  hash = 0;
  if (fb_law_create(name, facts, NULL, &law) != FB_OK) {
    printf("%s: %s\n", name, fb_last_error());
    return 1;
  }
  for (int n = 0; n < kTicks; ++n) {
    fb_motion motion = FB_INIT(fb_motion);
    motion.interval_s = n == 0 ? 0 : 1e-3 + 1e-6 * (n % 7);
    motion.position[0] = x_m;
    /* Of joints that are the tip's axes, where a device has others. */
    for (int32_t joint = 0; joint < info->joints && !info->cartesian; ++joint) {
      motion.joint[joint] = motion.position[joint];
      motion.jacobian[joint * info->joints + joint] = 1;
    }
    double request_N[FB_AXES_MAX] = {late_N[n % kLate], 0.1 * v_m_per_s};
    late_N[n % kLate] = x_m > 0 ? -5000 * x_m : 0;
    if (fb_law_tick(law, &motion, request_N, force_N, axes) != FB_OK) return printf("%s\n", fb_last_error()), 0;
    for (size_t axis = 0; axis < axes; ++axis) add(force_N[axis]);
    for (int step = 0; step < 6; ++step) {
      v_m_per_s += (force_N[0] + 1.5 - 2 * v_m_per_s) / 0.15 * (1e-3 / 6);
      x_m += v_m_per_s * (1e-3 / 6);
    }
  }
  fb_law_ledger(law, &ledger);
  printf("%s: %016" PRIx64 " of all forces, %.17g N at last, %.17g J left, at %.17g m\n", name, hash, force_N[0],
         ledger.energy_J, x_m);
  fb_law_destroy(law);
  return 1;
}

static void say(const char* what, fb_status status) {
  printf("%s: status %d: %s\n", what, (int)status, status ? fb_last_error() : "accepted");
}

int main(void) {
  const char* const kDevices[] = {"wall-1dof", "firm-3dof", "omni"};
  const char* name = NULL;
  fb_facts* facts = NULL;
  fb_facts_info info = FB_INIT(fb_facts_info);
  for (size_t i = 0; i < sizeof kDevices / sizeof *kDevices; ++i) {
    if (fb_facts_load(kDevices[i], &facts) != FB_OK || fb_facts_describe(facts, &info) != FB_OK) {
      return printf("%s\n", fb_last_error()), 1;
    }
    printf("%s, version %s\n", kDevices[i], fb_version());
    for (size_t law = 0; (name = fb_law_name(law)) != NULL; ++law) {
      if (!feel(name, facts, &info)) return 1;
    }
    if (i + 1 < sizeof kDevices / sizeof *kDevices) fb_facts_destroy(facts);
  }
  info.size = offsetof(fb_facts_info, latency_s);
  say("an older struct", fb_facts_describe(facts, &info));
  info.size = 3;
  say("a struct of no version", fb_facts_describe(facts, &info));
  fb_law* law = NULL;
  struct {
    fb_law_options known;
    double later;
  } newer = {FB_INIT(fb_law_options), 0};
  newer.known.size = sizeof newer;
  say("a newer struct that asks for nothing new", fb_law_create("none", facts, &newer.known, &law));
  fb_law_destroy(law);
  newer.later = 1;
  say("a newer struct that does", fb_law_create("none", facts, &newer.known, &law));
  fb_law_options options = FB_INIT(fb_law_options);
  options.parameters = "[vc]\nno_such = 1\n";
  say("a parameter that there is not", fb_law_create("vc", facts, &options, &law));
  say("a law that there is not", fb_law_create("no-such-law", facts, NULL, &law));
  fb_facts_destroy(facts);
  return 0;
}
