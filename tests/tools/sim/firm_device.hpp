#pragma once

#include "forcebound/device/load_device.hpp"

namespace forcebound::sim {

/// A device that can show 10 N/mm without a network, of three axes: 30 N s/m, 15 um, up to 30 N.
[[nodiscard]] inline device::DeviceDescription firm_device() {
  return device::parse_device(R"(
kind = "cartesian"
degrees_of_freedom = 3
mass_kg = 0.1
damping_N_s_per_m = 30
encoder_step_m = 15e-6
force_N_max = 30
latency_s = 50e-6
)",
                              "firm");
}

}  // namespace forcebound::sim
