#pragma once

#include "forcebound/wire/messages.hpp"

namespace forcebound::client {

/// Force of a surface's ripples at the device's present position. Rendered locally, because a force that crosses the
/// network is too late and too slow for them:
///
///     f = n max(-f_e . n, A mean_i sin(k_i . x))    while the depth  d - n . (x - x_e) > 0,   else zero
///
/// with the force f_e, the depth d and the place x_e of the server's answer. Together they never pull.
///
/// @param answer in contact or not, with or without a texture; its vectors that have rows have as many as `position`
/// @param position of the device now [m]
///
/// Real time: noexcept, no allocation, O(dof).
control::Vector texture_force_N(const wire::EnvironmentForce& answer, const control::Vector& position) noexcept;

}  // namespace forcebound::client
