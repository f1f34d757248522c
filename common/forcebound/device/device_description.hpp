#pragma once

#include <optional>
#include <string>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/device/kinematics.hpp"

namespace forcebound::device {

/// A simulated device: what a law may know of it, and what it moves like. The simulated damping and friction are
/// exactly the facts' bounds.
struct DeviceDescription {
  control::DeviceFacts facts;
  Matrix inertia;                  ///< of the joints: symmetric, positive definite [kg], [kg m^2]
  std::optional<ArmGeometry> arm;  ///< none: Cartesian
};

/// One line to print: name, degrees of freedom, inertia, damping, friction, encoder, each with its unit.
[[nodiscard]] std::string describe(const DeviceDescription& device);

/// The same of a device of which only the facts are known: all but the inertia.
[[nodiscard]] std::string describe(const control::DeviceFacts& facts);

}  // namespace forcebound::device
