#include "forcebound/client/app/device_options.hpp"

#include <CLI/CLI.hpp>

#include "forcebound/device/tick_rate.hpp"
#include "forcebound/law_plugin/known_laws.hpp"
#include "forcebound/program/command_line.hpp"

namespace forcebound::client {

void add_device_options(CLI::App& app, const DeviceOptions& options) {
  app.add_option("--device", options.device.device, "device to read, see below")->type_name("NAME|FILE.toml|DRIVER");
  app.add_option("--operator", options.device.hand, "hand on a simulated device, see below")->type_name("SPEC");
  app.add_option("--rate", options.device.rate_Hz,
                 "ticks per second, 500 to 4000: the device is read and commanded so often, and the law shows stiffer "
                 "walls the shorter a tick is; default: the device's own")
      ->check(program::number_within(device::kTickRateLeast_Hz, device::kTickRateMost_Hz))
      ->type_name("HZ");
  app.add_option("--law", options.law, "law that bounds the force, see below")
      ->transform(program::replaced_by(law_plugin::law_of_option))
      ->type_name("LAW|FILE.so")
      ->capture_default_str();
  app.add_option("--law-parameters", options.law_parameters, "a table for each law: [vc], coupling_N_per_m = 40000")
      ->check(program::not_empty())
      ->type_name("FILE.toml");
  app.add_option("--law-help", options.law_help,
                 "explain this law, its parameters and their values for --device, and end")
      ->transform(program::replaced_by(law_plugin::law_of_option))
      ->type_name("LAW|FILE.so");
  app.add_option("--memory", options.typed.memory,
                 "energy that fba-exact may store: as much as the largest force can need, or all")
      ->check(program::one_of("memory", {"capped", "full"}))
      ->type_name("capped|full")
      ->capture_default_str();
}

void add_late_force_options(CLI::App& app, TypedAges& ages) {
  app.add_option("--hold", ages.hold_ms, "age up to which a force is applied unchanged")
      ->check(program::number_within(0))
      ->capture_default_str()
      ->type_name("MS");
  app.add_option("--drop", ages.drop_ms, "age from which a force is replaced by zero")
      ->check(program::number_within(0))
      ->capture_default_str()
      ->type_name("MS");
}

LateForcePolicy policy_of(const TypedAges& ages) {
  const LateForcePolicy policy{.hold = time::from_seconds(ages.hold_ms * 1e-3),
                               .drop = time::from_seconds(ages.drop_ms * 1e-3)};
  program::value_of("--hold, --drop", [&] { policy.validate(); });
  return policy;
}

control::EnergyMemory memory_of(const TypedDevice& typed) {
  return typed.memory == "full" ? control::EnergyMemory::full : control::EnergyMemory::capped;
}

}  // namespace forcebound::client
