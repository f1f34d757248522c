/* A driver of an invented pen with a motor, complete. The hardware is four numbers in memory. */
#include <forcebound/driver/forcebound_device.h>

#include <stdio.h>

struct forcebound_device {
  int open;
  double position_m;
  double force_N;
};
static struct forcebound_device the_pen;

static int pen_open(const forcebound_setting* settings, size_t count, forcebound_device** device, char* error,
                    size_t error_bytes) {
  if (count > 0) {
    snprintf(error, error_bytes, "'%s' is not accepted; a pen has no settings", settings[0].key);
    return FORCEBOUND_FAILED;
  }
  the_pen.open = 1;
  *device = &the_pen;
  return FORCEBOUND_OK;
}

static int pen_describe(forcebound_device* device, forcebound_facts* facts) {
  (void)device;
  facts->degrees_of_freedom = 1;
  facts->period_s = 1e-3;
  facts->damping[0] = 0.8;
  facts->encoder_step[0] = 2e-5;
  facts->force_N_max = 3;
  facts->hold_s_max = 5e-3;
  return FORCEBOUND_OK;
}

static int pen_start(forcebound_device* device) { return device->open ? FORCEBOUND_OK : FORCEBOUND_FAILED; }

static int pen_read(forcebound_device* device, int64_t now_ns, forcebound_reading* reading) {
  reading->latched_ns = now_ns;
  reading->position_m[0] = device->position_m;
  return FORCEBOUND_OK;
}

static int pen_command(forcebound_device* device, const forcebound_command* command) {
  device->force_N = command->force_N[0];
  device->position_m += 1e-5 * device->force_N;
  return FORCEBOUND_OK;
}

static void pen_stop(forcebound_device* device) { device->force_N = 0; }
static void pen_close(forcebound_device* device) { device->open = 0; }

static const forcebound_driver the_driver = {
    .size = sizeof the_driver,
    .interface_version = FORCEBOUND_DEVICE_INTERFACE,
    .name = "pen",
    .description = "an invented pen",
    .open = pen_open,
    .describe = pen_describe,
    .start = pen_start,
    .read = pen_read,
    .command = pen_command,
    .stop = pen_stop,
    .close = pen_close,
};

const forcebound_driver* forcebound_driver_entry(uint32_t wanted) {
  (void)wanted;
  return &the_driver;
}
