#pragma once

namespace forcebound::control {

/// The ground-truth energy balance: P(t) = integral of (v'b v + sum c_i |v_i|) dt - integral of f'v dt, from rest at t
/// = 0 [Kim 2015, eq. 1-6].
///
/// Filled by a simulated device from its exact continuous motion and from nothing that a law believes.
struct PassivityAudit {
  double energy_J = 0;   ///< P now
  double minimum_J = 0;  ///< least P(t) so far, also between ticks
};

}  // namespace forcebound::control
