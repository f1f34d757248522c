#pragma once

#include "forcebound/control/vector.hpp"
#include "forcebound/scene/effects/effect.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::client {

using control::Vector;

/// Where a rippled surface is touched.
struct Contact {
  const Vector& normal;     ///< n, unit, out of the surface; no rows: nothing is touched
  const Vector& pushing_N;  ///< f_e, what pushes there
};

/// Ripples of a texture at the device's own place x; together with what pushes they never pull:
///
///     f = n max(-f_e . n, A mean_i sin(k_i . x))
///
/// Real time: noexcept, no allocation, O(dof).
[[nodiscard]] Vector ripples_N(const scene::Texture& texture, const Contact& contact, const Vector& position) noexcept;

/// Ripples of the surface that a server's answer says is touched, at the device's present position. Rendered locally,
/// because a force that crosses the network is too late and too slow for them. As `ripples_N`
///
///     while the depth  d - n . (x - x_e) > 0,   else zero
///
/// with the depth d and the place x_e of the answer.
///
/// @param answer in contact or not, with or without a texture; its vectors that have rows have as many as `position`
/// @param pushing_N f_e: of the answer's force what pushes there, all of it unless some parts run at the client
/// @param position of the device now [m]
///
/// Real time: noexcept, no allocation, O(dof).
Vector texture_force_N(const wire::EnvironmentForce& answer, const Vector& pushing_N, const Vector& position) noexcept;

inline Vector texture_force_N(const wire::EnvironmentForce& answer, const Vector& position) noexcept {
  return texture_force_N(answer, answer.force, position);
}

}  // namespace forcebound::client
