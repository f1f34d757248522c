#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "forcebound/client/commands/identify/identification.hpp"
#include "forcebound/device/device_description.hpp"
#include "forcebound/device/simulated/simulated_device.hpp"

namespace forcebound::lab::identification {

/// A simulated device with facts that nobody has told.
struct HiddenDevice {
  std::string kind;  ///< "1 axis", "2 axes", "3 axes", "arm"
  device::DeviceDescription description;
  device::DeviceFlaws flaws{};  ///< what it does or does not report
};

/// Light to heavy, encoders of 5 to 100 um at the tip, with and without friction, with latency and hold time.
[[nodiscard]] HiddenDevice draw_hidden_device(std::uint64_t seed);

/// What its maker would tell: degrees of freedom, largest force, period, the motors' gains to 10 %, and that nothing
/// else is known.
[[nodiscard]] control::DeviceFacts declared_facts(const HiddenDevice& hidden);

/// What somebody knows of its inertia, to 1 %.
[[nodiscard]] client::commands::identify::KnownMass known_mass(const HiddenDevice& hidden);

/// The device, with nobody's hand on it.
[[nodiscard]] std::unique_ptr<device::SimulatedDevice> without_hand(const device::DeviceDescription& description,
                                                                    const device::DeviceFlaws& flaws = {});

}  // namespace forcebound::lab::identification
