#pragma once

#include <string>

#include "forcebound/client/session/late_force_policy.hpp"
#include "forcebound/control/law_registry.hpp"
#include "forcebound/device/device_registry.hpp"

namespace CLI {
class App;
}

/// Options of all programs that run a device: as typed, not yet in the units and types of the options.
namespace forcebound::client {

struct TypedDevice {
  std::string memory = "capped";
};

/// Where what is typed goes. All must outlive the parsing.
struct DeviceOptions {
  device::DeviceRequest& device;
  std::string& law;
  std::string& law_parameters;
  std::string& law_help;
  TypedDevice& typed;
};

/// --device, --operator, --rate, --law, --law-parameters, --law-help and --memory: who feels what, and what bounds it.
void add_device_options(CLI::App& app, const DeviceOptions& options);

[[nodiscard]] control::EnergyMemory memory_of(const TypedDevice& typed);

struct TypedAges {
  double hold_ms = time::to_seconds(LateForcePolicy{}.hold) * 1e3;
  double drop_ms = time::to_seconds(LateForcePolicy{}.drop) * 1e3;
};

/// --hold and --drop. `ages` must outlive the parsing.
void add_late_force_options(CLI::App& app, TypedAges& ages);

/// @throws std::invalid_argument for hold > drop
[[nodiscard]] LateForcePolicy policy_of(const TypedAges& ages);

}  // namespace forcebound::client
