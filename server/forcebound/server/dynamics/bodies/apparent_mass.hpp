#pragma once

#include <vector>

#include "forcebound/server/dynamics/bodies/mujoco.hpp"

namespace forcebound::server {

/// The least mass [kg] that forces meet which pull at the centres of mass of these bodies (at least one), at all of
/// them at once and in whatever directions:
///
///     1 / largest eigenvalue of  J M^-1 J'        [inverse of the operational space inertia, Khatib 1987]
///
/// with the Jacobian J of all these centres and the mass matrix M as the bodies lie in `data`: joints count, contacts
/// and equalities do not, which could only add to it. A direction in which nothing can move is one of infinite mass,
/// and so is the whole if there is no other.
double apparent_mass_kg(const mjModel_& model, mjData_& data, const std::vector<int>& bodies);

}  // namespace forcebound::server
