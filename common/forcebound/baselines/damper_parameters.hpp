#pragma once

#include "forcebound/baselines/device_limits.hpp"
#include "forcebound/control/law_description.hpp"

/// Parameters of laws that add damping at the device.
namespace forcebound::baselines {

[[nodiscard]] inline control::LawParameter most_added_damping() {
  return {.name = "alpha_max_per_b",
          .purpose = "the most damping that may be added, as a multiple of the device's own",
          .most = 1e3,
          .standard = [](const control::DeviceFacts&) { return 1.0; }};
}

[[nodiscard]] inline control::LawParameter velocity_floor() {
  return {.name = "velocity_floor_m_per_s",
          .purpose = "nothing is damped at this speed or less",
          .standard = slowest_reading_m_per_s};
}

}  // namespace forcebound::baselines
