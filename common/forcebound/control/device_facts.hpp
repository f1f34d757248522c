#pragma once

#include <string>

#include "forcebound/control/vector.hpp"

namespace forcebound::control {

/// What is known of a haptic device, and all that a law may rely on.
///
/// Vectors and matrices have one row per degree of freedom. Damping, friction, encoders and motors of an arm live in
/// its joints, so these facts are given there: [N s/m], [N], [m] for a linear joint, [N m s/rad], [N m], [rad] for a
/// turning one. A Cartesian device is the case in which joints and task axes are the same.
struct DeviceFacts {
  std::string name;
  bool cartesian = true;     ///< the Jacobian is the identity
  double period_s = 1e-3;    ///< nominal length of a tick
  Matrix damping;            ///< positive definite lower bound of the physical damping
  Vector friction;           ///< lower bound of the Coulomb friction, >= 0
  Vector encoder_step;       ///< distance of two neighbouring readings, 0: ideal
  Vector actuator_step;      ///< distance of two neighbouring commands, 0: ideal
  double force_N_max = 0;    ///< largest tip force the device may be asked for
  double hold_s_max = 2e-3;  ///< the device layer zeroes a force in effect for exactly this long without a new one
  bool releases = true;      ///< false: it does not, so that only the next command ends a force
  double latency_s = 0;      ///< from the command to the force at the actuator: what the tick cannot measure

  [[nodiscard]] int degrees_of_freedom() const noexcept { return static_cast<int>(damping.rows()); }
};

}  // namespace forcebound::control
