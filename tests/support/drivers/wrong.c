/* Drivers with one thing wrong each, as the definitions say. */
#include <forcebound/driver/forcebound_device.h>

#include <stdlib.h>

#ifndef INTERFACE
#define INTERFACE FORCEBOUND_DEVICE_INTERFACE
#endif
#ifndef NAME
#define NAME "mute"
#endif

#ifndef WITHOUT_ENTRY
static int wrong_open(const forcebound_setting* settings, size_t count, forcebound_device** device, char* error,
                      size_t error_bytes) {
  (void)settings, (void)count, (void)device, (void)error, (void)error_bytes;
#ifdef CRASHES_IN_OPEN
  abort();
#else
  return FORCEBOUND_FAILED;
#endif
}
static int wrong_describe(forcebound_device* device, forcebound_facts* facts) {
  (void)device, (void)facts;
  return FORCEBOUND_FAILED;
}
static int wrong_start(forcebound_device* device) {
  (void)device;
  return FORCEBOUND_FAILED;
}
static int wrong_read(forcebound_device* device, int64_t now_ns, forcebound_reading* reading) {
  (void)device, (void)now_ns, (void)reading;
  return FORCEBOUND_FAILED;
}
#ifndef WITHOUT_COMMAND
static int wrong_command(forcebound_device* device, const forcebound_command* command) {
  (void)device, (void)command;
  return FORCEBOUND_FAILED;
}
#else
#define wrong_command NULL
#endif
static void wrong_stop(forcebound_device* device) { (void)device; }

static const forcebound_driver kWrong = {
    .size = sizeof kWrong,
    .interface_version = INTERFACE,
    .name = NAME,
    .description = NULL,
    .settings = NULL,
    .open = wrong_open,
    .describe = wrong_describe,
    .start = wrong_start,
    .read = wrong_read,
    .command = wrong_command,
    .stop = wrong_stop,
    .close = wrong_stop,
    .last_error = NULL,
};

const forcebound_driver* forcebound_driver_entry(uint32_t wanted) {
  (void)wanted;
  return &kWrong;
}
#else
int nothing_of_a_driver(void);
int nothing_of_a_driver(void) { return 0; }
#endif
