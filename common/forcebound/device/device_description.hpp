#pragma once

#include <string>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/device/kinematics/geometry.hpp"
#include "forcebound/device/safety.hpp"

namespace forcebound::device {

/// A simulated device: the facts that a law may use, and the parameters of its motion. The simulated damping and
/// friction equal the facts' bounds exactly.
struct DeviceDescription {
  control::DeviceFacts facts;
  Matrix inertia;  ///< of the joints: symmetric, positive definite [kg], [kg m^2]
  Geometry geometry{};
  Safety safety{};         ///< for the hand on it
  bool identified = true;  ///< false: the bounds of the real device were never measured; they are guesses
};

/// One line to print: name, degrees of freedom, inertia, damping, friction, encoder, each with its unit.
[[nodiscard]] std::string describe(const DeviceDescription& device);

/// As above without the inertia, for a device of which only the facts are known.
[[nodiscard]] std::string describe(const control::DeviceFacts& facts);

}  // namespace forcebound::device
