#pragma once

#include <vector>

#include "forcebound/server/dynamics/bodies/mujoco.hpp"

namespace forcebound::server {

/// The least mass [kg] felt by forces at the centres of mass of these bodies (at least one), over all combinations of
/// directions at all of them at once:
///
///     1 / largest eigenvalue of  J M^-1 J'        [inverse of the operational space inertia, Khatib 1987]
///
/// with the Jacobian J of all these centres and the mass matrix M for the positions in `data`: joints count, contacts
/// and equalities do not, which could only add to it. The mass is infinite in a direction in which nothing can move,
/// and so is the result if there is no other direction.
double apparent_mass_kg(const mjModel_& model, mjData_& data, const std::vector<int>& bodies);

}  // namespace forcebound::server
